"""The program ``armtwin``, by the engine that is in the wheel.

The engine is loaded without the package around it: no numpy, whose threads would take the signals that the
program waits for, and no time for its import.
"""

from __future__ import annotations

import sys
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType


def _engine() -> ModuleType:
    package = find_spec("armtwin")
    if package is None or package.origin is None:
        raise ImportError("the package armtwin is missing beside armtwin_program")
    folder = Path(package.origin).parent
    file = next(f for suffix in EXTENSION_SUFFIXES if (f := folder / f"_engine{suffix}").exists())
    loader = ExtensionFileLoader("armtwin._engine", str(file))
    spec = spec_from_file_location("armtwin._engine", file, loader=loader)
    if spec is None:
        raise ImportError(f"{file} cannot be loaded")
    module = module_from_spec(spec)
    loader.exec_module(module)
    return module


def main() -> None:
    """Run the command line."""
    sys.exit(_engine().main(["armtwin", *sys.argv[1:]]))
