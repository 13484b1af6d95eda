"""`fmbd schema`: the JSON Schema of model files, for editors."""

import argparse
from typing import Any

from fmbd.cli.common import DONE


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "schema",
        help="print the JSON Schema of model files",
        description="Print the JSON Schema of model files. An editor with a YAML language server completes and checks "
        "a model whose first line is: # yaml-language-server: $schema=fmbd.schema.json",
    )
    parser.set_defaults(command=_print)


def _print(args: argparse.Namespace) -> int:
    from fmbd.model.schema import schema_text

    print(schema_text(), end="")
    return DONE
