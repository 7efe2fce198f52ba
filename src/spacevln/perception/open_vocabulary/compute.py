"""Where and how precisely a model computes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from spacevln.core import PrerequisiteError, UsageError
from spacevln.perception.open_vocabulary.checkpoints import need

Device = Literal["auto", "cpu", "cuda", "mps"]
Precision = Literal["float32", "float16", "bfloat16"]


@dataclass(frozen=True, slots=True)
class Compute:
    """Where and how precisely.

    Args:
        device: ``auto`` takes a GPU where there is one.
        dtype: of weights and activations; halves need a GPU that has them.
    """

    device: Device = "auto"
    dtype: Precision = "float32"

    def place(self, model: Any) -> Any:
        """The model there, for inference only.

        Raises:
            PrerequisiteError: there is no such device.
            UsageError: the device cannot compute so.
        """
        torch = need("torch")
        device = self.resolved
        if device == "cpu" and self.dtype == "float16":
            raise UsageError("float16 needs a GPU: take float32 or bfloat16 on the CPU.")
        return model.to(device=device, dtype=getattr(torch, self.dtype)).eval().requires_grad_(False)

    @property
    def resolved(self) -> str:
        """The device that ``auto`` means here."""
        torch = need("torch")
        present = {"cpu": True, "cuda": torch.cuda.is_available(), "mps": torch.backends.mps.is_available()}
        if self.device == "auto":
            return next(name for name in ("cuda", "mps", "cpu") if present[name])
        if not present[self.device]:
            raise PrerequisiteError(f"Device {self.device!r} is not here: use --device cpu, or a torch built for it.")
        return self.device
