// The smooth border of a set of voxels.
#pragma once
#include <chiaro/geometry.h>

#include <array>
#include <cstdint>
#include <vector>

namespace chiaro {

/// From a set of voxels to the signed distance of its border: of a border that is smooth, that leaves each voxel's
/// centre on its own side, and that lies within a third of a voxel of the one that was sampled.
///
/// A half-space smoothed by a Gaussian of deviation σ is Φ(d / σ). A curved border moves by σ² times its mean
/// curvature; 2 G(σ) - G(2σ) keeps its place, since both terms move its value of ½ alike. σ must be as wide as the
/// terraces of a sampled border, and as narrow as what is to be kept: σ is 2.25 voxels (balls of radius 10, 30, 60:
/// normals are off by 1 to 2 %), and where that does not tell a structure from what surrounds it - no voxel of the 3³
/// around one is well on its own side - it is 1.2 (tubes of radius 1.5 and 2: 3 to 5 %, where .6 has 8 to 10), and
/// where that does not, .6 (tubes and sheets of 2 voxels keep their volume).
///
/// Of slices that lie farther apart than their pixels terraces are as many times wider, so σ is wider along the pixels
/// and narrower across the slices (border_widths), and distances are by the slope that the smoothed values have there.
class BorderTile {
public:
    static constexpr int edge = 32;    ///< voxels per axis that a tile answers for
    static constexpr float reach = 2;  ///< voxels; distances beyond are this

    using Widths = std::array<float, 3>;

    /// `widths`: how many times 2.25 voxels σ is along each axis.
    explicit BorderTile(const Widths& widths = {1, 1, 1});
    static int halo_of(const Widths& widths);  ///< voxels known around the tile's
    int halo() const { return halo_; }
    int row() const { return row_; }  ///< edge and a halo on either side
    /// `inside`: row³, x fastest, 1 in the set, else 0. The distances, edge³, are positive inside. Cost: 1 to 3
    /// core-ms; of thick slices three times as much.
    const std::vector<float>& distance(const std::vector<std::uint8_t>& inside);

private:
    static constexpr Widths alike{1, 1, 1};
    static int margin_of(const Widths& widths) { return widths == alike ? 4 : 5; }
    void smooth(float sigma, const Widths& widths, std::vector<float>& out);
    void divide_by_slope(float sigma, const Widths& widths, std::vector<float>& out) const;
    void find_thin();
    void take_narrower();

    Widths widths_;
    int margin_, span_;  ///< smoothed values, for four or five looks at neighbours
    int halo_, row_;
    std::vector<float> source_;  ///< row³: ½ inside, -½ outside
    std::vector<float> own_;     ///< span³: the same
    std::vector<float> along_x_, along_y_, narrow_, wide_;
    std::vector<float> smooth_, local_, thin_;  ///< span³
    std::vector<float> distance_;
    bool any_thin_ = false;
};

/// For voxels of this spacing: 1 along all axes, unless one is 1.5 times as long as another. Of a ball of radius 30 mm
/// in slices 5 mm apart with pixels of 1 mm, 2.24 along the pixels and .6 across the slices leave 4 % of terraces in
/// the shade, 1 along all axes 13 %.
std::array<float, 3> border_widths(const Vec3& spacing_mm);

}  // namespace chiaro
