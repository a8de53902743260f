// Plane sections of a volume: its values at the pixels of a picture that lies in the world.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/export.h>
#include <chiaro/labels.h>
#include <chiaro/medium.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

enum class SliceSampling { linear, nearest };

/// Where the pixels lie. The two steps need not be orthogonal, nor of one length.
struct SlicePlane {
    Vec3 centre_mm;                            ///< the picture's middle, in the world
    Vec3 right_mm{1, 0, 0}, down_mm{0, 1, 0};  ///< from a pixel to the next one of its row, of its column
    int width = 0, height = 0;                 ///< pixels

    /// The world at (column, row), where pixel centres are whole numbers.
    Vec3 at(double column, double row) const {
        return centre_mm + (column - 0.5 * (width - 1)) * right_mm + (row - 0.5 * (height - 1)) * down_mm;
    }
};

/// Values in data units, row 0 on top; NaN outside of the volume.
struct Slice {
    int width = 0, height = 0;
    std::vector<double> values;
};

/// The values at the pixels' centres: trilinear, or those of the nearest voxels, which are the file's to the last bit
/// where DeviceVolume::is_exact. The volume ends half a voxel beyond its outermost voxel centres; up to there the
/// outermost value holds. Cost: some 20 ns a pixel and core. Throws Error{usage} for a plane without pixels or with
/// more than 2^26, or numbers that are not finite.
CHIARO_EXPORT Slice slice(const DeviceVolume& volume, const SlicePlane& plane, SliceSampling sampling);

/// The same of a volume by bricks, of which only what the plane passes is read, in pieces of at most 16 million voxels:
/// the coarsest level whose voxels are no larger than a pixel, or with `finest` level 0. `whole`: a level that is in
/// memory (Session::volume), for the range of values. Throws as BrickSource::read, Error{interrupted} when cancelled.
CHIARO_EXPORT Slice slice(const BrickSource& source, const DeviceVolume& whole, const SlicePlane& plane,
                          SliceSampling sampling, bool finest, Progress& progress);

/// The numbers of labels (LabelVolume::numbers) at the pixels' centres: those of the nearest voxels; 0 outside. The
/// labels lie in the volume as place_labels has it, and as it throws. Cost: as above.
CHIARO_EXPORT std::vector<std::uint16_t> slice(const LabelVolume& labels, const DeviceVolume& volume,
                                               const SlicePlane& plane);

// What a viewer shows of slices, as a scene keeps it; pictures of the volume are made without.
enum class SliceLayout { volume, linked, axial, coronal, sagittal, oblique };
enum class SliceColors { grey, transfer };
enum class SliceSide { radiological, neurological };

struct SliceSettings {
    SliceLayout layout = SliceLayout::volume;  ///< the volume alone, with three slices, or one of them large
    std::optional<Vec3> at_mm;                 ///< that all slices pass through, world; none: the volume's centre
    std::optional<Vec3> centre_mm;             ///< of what is shown of them, likewise
    double zoom = 1;                           ///< 1: all of the slice is seen
    std::optional<std::pair<double, double>> window;  ///< centre and width of the grey levels; none: by the percentiles
    SliceSampling sampling = SliceSampling::linear;
    SliceColors colors = SliceColors::grey;
    SliceSide side = SliceSide::radiological;
    bool outlines = true;  ///< where the slices lie is drawn in the volume
    double labels = 0.4;   ///< opacity of labels over slices; their borders are not see-through
    bool operator==(const SliceSettings&) const = default;
};

/// A plane across one of the volume's own axes, as people look at it.
struct Section {
    std::string name;  ///< "axial", "coronal", "sagittal"; of a volume without a frame "z", "y", "x"
    int axis = 0;      ///< of the volume: a step along it is the next slice
    Vec3 right, down;  ///< unit vectors along the other two, in the world
};

/// The axial, coronal and sagittal one: across the axis that runs nearest to that of the body. Radiological: the
/// patient's left is at the right; front is up (axial) or at the left (sagittal), head is up. Without a frame z, y and
/// x: x to the right, z up where it lies in the picture, else y down.
CHIARO_EXPORT std::array<Section, 3> sections_of(const Geometry& geometry);

}  // namespace chiaro
