"""Many runs with one question: is a model right (`verify`), how right (`refine`), what matters (`sensitivity`)?"""
