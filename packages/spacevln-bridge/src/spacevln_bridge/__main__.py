"""``python -m spacevln_bridge``, or this folder's path given to another Python that has no spacevln_bridge of its own."""

import importlib.util
import os
import sys

if not __package__:
    here = os.path.dirname(os.path.abspath(__file__))  # noqa: PTH100, PTH120 - only builtins before the package is found
    sys.path[:] = [entry for entry in sys.path if os.path.abspath(entry or ".") != here]  # noqa: PTH100
    found = importlib.util.spec_from_file_location(
        "spacevln_bridge",
        os.path.join(here, "__init__.py"),  # noqa: PTH118
        submodule_search_locations=[here],
    )
    assert found is not None and found.loader is not None  # noqa: S101, PT018 - a path that exists
    package = importlib.util.module_from_spec(found)
    sys.modules["spacevln_bridge"] = package
    found.loader.exec_module(package)

from spacevln_bridge.worker import main

if __name__ == "__main__":
    main()
