"""A model's document as YAML text again, once values have been changed in it."""

from typing import Any

import yaml

from fmbd.model.document import scalar

# PyYAML writes these as they are and reads them as ends of lines
_LINE_BREAKS = set("\x85\u2028\u2029")


class _Dumper(yaml.SafeDumper):
    """Writes what `document.parse` reads back as the same data."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _text(dumper: _Dumper, value: str) -> yaml.ScalarNode:
    """Text that would be read as something else is quoted: a parameter '1e-6' stays an expression."""
    plain = isinstance(scalar(value), str) and not _LINE_BREAKS & set(value)
    style = None if plain else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", value, style)


_Dumper.add_representer(str, _text)


def yaml_text(data: Any) -> str:
    """Plain data as YAML, keys in their order."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=None)
