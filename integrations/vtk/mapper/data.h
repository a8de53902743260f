// From VTK's data to Chiaro's volume.
#pragma once
#include <chiaro/volume.h>

#include <optional>

class vtkDataArray;
class vtkImageData;
class vtkMatrix4x4;

namespace chiaro::from_vtk {

/// How a volume stands in VTK's world. What keeps angles belongs to the camera, so that moving a volume reads no voxel
/// again; any other matrix to the volume's own geometry.
struct Placement {
    std::array<double, 16> world_from_volume;  ///< by rows
    double scale;                              ///< of lengths by it
    Geometry geometry;                         ///< of the voxels: in the space behind that
};

/// `at_cells`: values stand at the centres of cells.
Placement placement_of(vtkImageData& image, bool at_cells, vtkMatrix4x4& matrix);

/// Of a vector of the world, in the volume's own space but for its length.
Vec3 turned_back(const Placement& place, Vec3 v);

/// None for a type that Chiaro has none for (bits).
std::optional<VoxelType> type_of(vtkDataArray& scalars);

/// The voxels are VTK's own, which it keeps.
Volume volume_of(vtkImageData& image, vtkDataArray& scalars, bool at_cells, const Geometry& geometry);

/// A volume for each value of a voxel. Of dependent ones first what opacity is by, then what has the colour.
std::vector<Volume> channels_of(const Volume& voxels, bool dependent);

/// As a block of the grid of the whole; `image`: null where there are no voxels. `own`: of the grid's points or cells,
/// half-open.
void place(Volume& voxels, vtkImageData& grid, vtkImageData* image, bool at_cells, const std::array<int, 6>& own);

}  // namespace chiaro::from_vtk
