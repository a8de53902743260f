// The smooth border of a set of voxels.
#pragma once
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
class BorderTile {
public:
    static constexpr int edge = 32;  ///< voxels per axis that a tile answers for
    static constexpr int halo = 18;  ///< known around them
    static constexpr int row = edge + 2 * halo;
    static constexpr float reach = 2;  ///< voxels; distances beyond are this

    BorderTile();
    /// `inside`: row³, x fastest, 1 in the set, else 0. The distances, edge³, are positive inside. Cost: 1 to 3
    /// core-ms.
    const std::vector<float>& distance(const std::vector<std::uint8_t>& inside);

private:
    static constexpr int margin = 4, span = edge + 2 * margin;  ///< smoothed values, for four looks at neighbours
    void smooth(float sigma, std::vector<float>& out);
    void find_thin();
    void take_narrower();
    float own(int voxel) const { return source_[std::size_t(source_of(voxel))]; }
    static int source_of(int voxel);

    std::vector<float> source_;  ///< row³: ½ inside, -½ outside
    std::vector<float> along_x_, along_y_, narrow_, wide_;
    std::vector<float> smooth_, local_, thin_;  ///< span³
    std::vector<float> distance_;
    bool any_thin_ = false;
};

}  // namespace chiaro
