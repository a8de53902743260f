#include "illumination/lit_field.h"

namespace chiaro {

LitField lit_field(const IlluminationField& field, const Lighting& lighting, Vec3 orbit_up,
                   const Medium::Data& medium) {
    const IlluminationField::Data& data = field.data();
    if (data.visibility) {
        const Geometry& geometry = medium.volume.geometry();
        const bool by_normal = medium.shape.mode == Mode::iso && lighting.shading != Shading::none;
        const auto lit = data.visibility->light({lighting, orbit_up, geometry, by_normal});
        return {lit->view, lit->main, lit};
    }
    LitField lit{data.view, {}, {}};
    if (auto* access = std::get_if<kernel::AccessView>(&lit.view)) access->strength = float(lighting.strength);
    return lit;
}

}  // namespace chiaro
