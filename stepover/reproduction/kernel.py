"""The kernel that runs the notebooks: that of this very Python, whatever kernels the user has installed by name."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jupyter_client.manager import AsyncKernelManager


def own_kernel() -> type[AsyncKernelManager]:
    """A class of kernel managers that start this interpreter, for nbclient and papermill.

    Another Python may have installed a kernel under the name python3, and Jupyter would take that one.
    """
    from jupyter_client.kernelspec import KernelSpec
    from jupyter_client.manager import AsyncKernelManager

    class OwnKernel(AsyncKernelManager):
        """Starts this interpreter's ipykernel."""

        @property
        def kernel_spec(self) -> KernelSpec:
            """What is started."""
            command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
            return KernelSpec(argv=command, display_name="Python 3", language="python")

    return OwnKernel
