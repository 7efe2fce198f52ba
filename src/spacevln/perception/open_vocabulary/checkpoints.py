"""Opening checkpoint files: never run what is in them, and say in a sentence what is wrong with one.

safetensors files hold numbers only. A pickled file, which is what some projects publish, is read by torch's weights-only reader,
which knows tensors and plain containers and refuses everything else before it is called.
"""

from __future__ import annotations

import importlib
import pickle
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from spacevln.core import PrerequisiteError, UsageError


def need(module: str, extra: str = "perception") -> ModuleType:
    """An optional library.

    Raises:
        PrerequisiteError: it is not installed, or broken beside what else is installed.
    """
    try:
        return importlib.import_module(module)
    except (ImportError, RuntimeError) as error:  # a torchvision of another torch raises RuntimeError
        raise PrerequisiteError(
            f"{module} cannot be imported ({_reason(error)}): run pip install 'spacevln[{extra}]'."
        ) from error


def load_tensors(path: Path) -> dict[str, Any]:
    """The tensors of a ``.safetensors`` file, or of a ``.pt`` file that holds a flat table of them, on the CPU.

    Raises:
        UsageError: the file is missing, truncated, not a checkpoint, or holds more than tensors.
    """
    torch = need("torch")
    if not path.is_file():
        raise UsageError(f"The checkpoint {str(path)!r} does not exist: give a file, or run spacevln models list.")
    try:
        if path.suffix == ".safetensors":
            loaded: object = need("safetensors.torch").load_file(path)
        else:
            loaded = torch.load(path, map_location="cpu", weights_only=True)
    except pickle.UnpicklingError as error:
        raise UsageError(
            f"The checkpoint {str(path)!r} is refused: it is damaged, or holds code or objects instead of weights; fetch it anew "
            "with spacevln models download."
        ) from error
    except (OSError, EOFError, ValueError, RuntimeError, KeyError, need("safetensors").SafetensorError) as error:
        raise UsageError(
            f"The checkpoint {str(path)!r} cannot be read ({_reason(error)}): fetch it anew with spacevln models download."
        ) from error
    if not isinstance(loaded, dict) or not all(isinstance(value, torch.Tensor) for value in loaded.values()):
        raise UsageError(f"The checkpoint {str(path)!r} is no flat table of tensors: give the file as it was published.")
    return loaded


def check_layout(found: Mapping[str, Any], expected: Mapping[str, Any], path: Path, model: str) -> None:
    """Whether a file has the names and shapes of a model.

    Raises:
        UsageError: it has not; the sentence names the first difference.
    """
    missing, unknown = sorted(expected.keys() - found.keys()), sorted(found.keys() - expected.keys())
    wrong = [name for name in sorted(expected.keys() & found.keys()) if found[name].shape != expected[name].shape]
    if missing:
        what = f"{missing[0]} is missing ({len(missing)} of {len(expected)} are)"
    elif unknown:
        what = f"{unknown[0]} is unknown ({len(unknown)} are)"
    elif wrong:
        what = f"{wrong[0]} has shape {tuple(found[wrong[0]].shape)} instead of {tuple(expected[wrong[0]].shape)}"
    else:
        return
    raise UsageError(f"The checkpoint {str(path)!r} is no {model}: {what}; fetch it with spacevln models download {model}.")


def from_folder(model_class: Any, folder: Path, **options: Any) -> Any:
    """A transformers model from a local folder: safetensors only, no code from the folder, no network.

    Raises:
        UsageError: the folder is incomplete or damaged.
    """
    errors = (OSError, ValueError, RuntimeError, KeyError, TypeError, need("safetensors").SafetensorError)
    try:
        return model_class.from_pretrained(folder, local_files_only=True, trust_remote_code=False, **options)
    except errors as error:
        raise UsageError(
            f"The model in {str(folder)!r} cannot be opened ({_reason(error)}): fetch it anew with spacevln models download."
        ) from error


def _reason(error: BaseException) -> str:
    """The first line of an error, or its name."""
    return next(iter(str(error).strip().splitlines()), type(error).__name__)
