// Where the mean opacity of any cube can be looked up: stored levels, or a table of sums.
#pragma once
#include "core/threads.h"
#include "illumination/access.h"
#include "illumination/spao/launch.h"
#include "illumination/spao/sums.h"

namespace chiaro {

/// The cells of a stored level, with a layer of zeros on every side; index = cell × scale + shift.
struct LevelShape {
    std::array<int, 3> count;
    double scale = 1, shift = 1;

    static LevelShape of(const CellGrid& grid);
    LevelShape mipmap() const;               ///< one level wider, half as many cells
    LevelShape nbuffer(int distance) const;  ///< of windows longer by `distance`, by which each axis grows
    std::size_t size() const { return std::size_t(count[0]) * count[1] * count[2] + 8; }  ///< look-ups read two at once
    kernel::StoredLevels::Level view(const std::uint16_t* cells) const {
        return {cells, count[0], count[1], count[2], float(scale), float(shift)};
    }
};
inline std::string name_of_level(int level) { return "spao level " + std::to_string(level); }
kernel::StoredKernel stored_kernel(const kernel::StoredLevels& levels, const SpaoSettings& settings);

/// Mipmaps up to level m, then N-buffers on the grid of 2^m cells: m = 0 is N-buffers alone, m = levels mipmaps alone.
/// Memory: two bytes a cell and level, and 8^m times less from level m on; N-buffers reach half a cube beyond the grid.
class SpaoLevels {
public:
    /// Levels 0 to `top`. Throws Error{output} without the memory for them, Error{interrupted} when cancelled.
    SpaoLevels(const Device& device, const CellOpacity& opacity, int mip_levels, int top, StageTimer& timer,
               Progress& progress);
    kernel::StoredLevels view() const;
    std::size_t bytes() const;

private:
    struct Level {
        LevelShape shape;
        VoxelBuffer cells;
        explicit Level(const LevelShape& s) : shape(s), cells(s.size() * sizeof(std::uint16_t)) {}
        std::uint16_t* row(int y, int z);
        const std::uint16_t* row(int y, int z) const;
    };

    template <class Levels>
    friend void level_steps(Levels& levels, int mip_levels, int top, StageTimer& timer);
    void copy_opacity();
    void add_mipmap();
    void add_nbuffer(int distance);

    Device device_;
    kernel::SpaoFunctions run_;
    const CellOpacity& opacity_;  ///< while levels are made, as
    Progress& progress_;
    std::vector<Level> levels_;
};

/// For tests and small volumes: 8 bytes a cell.
class SummedOpacity {
public:
    SummedOpacity(const Device& device, const CellValues& opacity, Progress& progress);
    kernel::OpacitySums view() const { return {sums_.data(), {count_[0], count_[1], count_[2]}}; }

private:
    std::array<int, 3> count_;
    std::vector<std::int64_t> sums_;
};
kernel::ExactKernel exact_kernel(const kernel::OpacitySums& sums, const SpaoSettings& settings);
inline std::size_t sums_of(const std::array<int, 3>& cells) {
    return std::size_t(cells[0] + 1) * std::size_t(cells[1] + 1) * std::size_t(cells[2] + 1);
}

}  // namespace chiaro
