// What stands behind vtkChiaroVolumeMapper.
#pragma once
#include <chiaro/describe.h>
#include <chiaro/exchange.h>
#include <chiaro/image.h>
#include <chiaro/session.h>

#include <set>

#include "data.h"
#include "picture.h"
#include "vtkChiaroVolumeMapper.h"
#include "vtkImageData.h"
#include "vtkSmartPointer.h"

class vtkDataArray;

namespace chiaro::from_vtk {

/// What is shown, and where it stands.
struct Subject {
    vtkImageData* image = nullptr;  ///< null: this process has no voxels
    vtkDataArray* scalars = nullptr;
    int at_cells = 0;
    bool dependent = false;        ///< its values say together what it looks like
    vtkImageData* grid = nullptr;  ///< of the whole
    Placement place{};
};

/// What a shown volume was made from.
struct Shown {
    vtkDataArray* scalars = nullptr;
    vtkMTimeType time = 0;  ///< of the image and its scalars
    bool at_cells = false, dependent = false;
    Geometry geometry;
    int threads = 0;
    bool operator==(const Shown&) const = default;
};

/// "name value", for messages about settings.
inline std::string written(std::string_view name, std::string_view value) {
    return std::string(name) + " " + std::string(value);
}

}  // namespace chiaro::from_vtk

struct vtkChiaroVolumeMapper::Internals {
    chiaro::GivenSettings given;
    std::optional<chiaro::Scene> scene;  ///< of a file; none: VTK's own settings tell
    chiaro::from_vtk::Shown shown;
    std::unique_ptr<chiaro::Session> session;
    std::shared_ptr<const chiaro::RayEnds> ends;
    std::set<std::string> warned;
    chiaro::from_vtk::Picture picture;
    double seconds_a_pixel = 0;
    std::shared_ptr<chiaro::Exchange> ranks;  ///< that hold blocks of the volume; null: it is whole
    vtkSmartPointer<vtkImageData> grid;       ///< of the whole then
    std::array<int, 6> own{};

    /// The picture of all processes' rays; empty but on the first. None: each process draws its own block.
    std::optional<chiaro::Frame> together;
    bool fills_window = false;  ///< the window's frame under way: with the whole picture of a scene of a file

    std::string frame_file;  ///< empty: none
    void keep_frame(const chiaro::Frame& frame, const chiaro::ToneMap& tone) const {
        if (!frame_file.empty()) chiaro::write_exr(chiaro::expose(frame, tone), frame_file);
    }

    /// Whether all ranks say so.
    bool agree(bool yes) { return ranks ? ranks->agree(yes) : yes; }

    /// The last ones where they are the same: rays need not be cast again.
    void keep(std::shared_ptr<const chiaro::RayEnds> newest) {
        if (newest && ends && newest->width == ends->width && newest->height == ends->height && newest->mm == ends->mm)
            return;
        ends = std::move(newest);
    }
};
