// A field under a light: what the ray caster looks up.
#pragma once
#include "classify/medium.h"
#include "illumination/field.h"

namespace chiaro {

/// Where most of a probe's light comes from.
struct MainLight {
    Vec3 direction;  ///< unit, world, towards the light
    double share;    ///< 0: from everywhere alike, 1: from this direction alone
};

struct LitField {
    FieldView view;
    std::optional<MainLight> main;      ///< missing: the lighting's own light
    std::shared_ptr<const void> keeps;  ///< what the view reads
};

/// Joins field and lighting; a probe is projected on the field where that holds no light of its own.
LitField lit_field(const IlluminationField& field, const Lighting& lighting, Vec3 orbit_up, const Medium::Data& medium);

}  // namespace chiaro
