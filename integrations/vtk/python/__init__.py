"""vtkChiaroVolumeMapper, for the vtkmodules of the VTK that it was built with."""

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  what draws, in the factories of VTK
from chiarovtk.vtkChiaro import vtkChiaroVolumeMapper

__all__ = ["vtkChiaroVolumeMapper"]
