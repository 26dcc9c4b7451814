"""``python reports/verify RUN_DIR``, and ``python -m reports.verify RUN_DIR`` from the top of the repository."""

import sys
from importlib import import_module
from pathlib import Path

if __name__ == "__main__":
    here = Path(__file__).resolve().parent
    if not __package__:  # started as a folder: its files know each other as a package, by whatever name the folder has
        sys.path[0] = str(here.parent)
    sys.exit(import_module(f"{__package__ or here.name}.report").main())
