#include "illumination/light_at.h"

#include "illumination/lit_field.h"

namespace chiaro {

std::vector<Rgb> light_at(const IlluminationField& field, const Lighting& lighting, const Camera& camera,
                          const Medium::Data& medium, std::span<const Vec3> points_voxel) {
    const LitField lit = lit_field(field, lighting, camera, medium);
    lit.come();
    kernel::ShadingView unshaded{};
    unshaded.ambient = 1;
    std::vector<Rgb> found;
    found.reserve(points_voxel.size());
    std::visit(
        [&](const auto& view) {
            for (const Vec3& p : points_voxel) {
                kernel::SamplePoint<float> sample{{float(p.x), float(p.y), float(p.z)}, 0};
                const kernel::Vec3<float> e = view.incident(sample, unshaded).diffuse;
                found.push_back({e.x, e.y, e.z});
            }
        },
        lit.view);
    return found;
}

}  // namespace chiaro
