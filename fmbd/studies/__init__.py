"""Many runs with one question: is a model right (`verify`), and how right (`refine`)?"""
