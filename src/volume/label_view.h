// What labels leave of a sample, and how they tint it.
#pragma once
#include "kernel/rgba.h"
#include "volume/label_coding.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// Linear between voxels.
template <class F>
CHIARO_INLINE F byte_at(const std::uint8_t* bytes, const Location<F>& at) {
    VolumeView<std::uint8_t> volume{};
    volume.voxels = bytes;
    return volume.value(at);
}

/// Where the border of what is shown lies: voxels, positive in it.
template <class F>
CHIARO_INLINE F distance_at(const LabelView& labels, const Location<F>& at) {
    return F(1 / LabelCoding::per_voxel) * (byte_at(labels.distance, at) - F(LabelCoding::middle));
}
/// What a border leaves half a voxel before and behind it.
template <class F>
CHIARO_INLINE F left_at(F distance) {
    return min(max(distance + F(0.5f), F(0)), F(1));
}
template <class F>
CHIARO_INLINE F share_of(const std::uint8_t* share, const Location<F>& at) {
    return F(1.0f / 255) * byte_at(share, at);
}
template <class F>
CHIARO_INLINE F share_at(const LabelView& labels, const Location<F>& at) {
    return labels.share ? share_of(labels.share, at) : F(1);
}
/// Per voxel.
template <class F>
CHIARO_INLINE Vec3<F> share_gradient(const std::uint8_t* share, const Location<F>& at) {
    VolumeView<std::uint8_t> volume{};
    volume.voxels = share;
    return F(1.0f / 255) * volume.differences(at);
}

/// Square roots of red, green and blue, and the strength.
template <class F>
CHIARO_INLINE Four<F> tint_between(const LabelView& labels, const Location<F>& at) {
    constexpr Distances beside{0, brick_row, brick_slice, brick_slice + brick_row};
    const Four<Four<F>> a = gather_bytes(labels.tint, at.index, beside),
                        b = gather_bytes(labels.tint + 1, at.index, beside);
    const auto between = [&](auto value_of) CHIARO_INLINE_LAMBDA {
        const F near = lerp(lerp(value_of(a.a), value_of(b.a), at.t.x), lerp(value_of(a.b), value_of(b.b), at.t.x),
                            at.t.y),
                far = lerp(lerp(value_of(a.c), value_of(b.c), at.t.x), lerp(value_of(a.d), value_of(b.d), at.t.x),
                           at.t.y);
        return lerp(near, far, at.t.z);
    };
    const auto root = [&](F Four<F>::*channel) CHIARO_INLINE_LAMBDA {
        return F(1.0f / 255) * between([&](const Four<F>& word) CHIARO_INLINE_LAMBDA { return word.*channel; });
    };
    // Without its byte's lowest bit, which tells of several tints.
    const auto strength = [](const Four<F>& word) CHIARO_INLINE_LAMBDA { return floor(F(0.5f) * word.d); };
    return {root(&Four<F>::a), root(&Four<F>::b), root(&Four<F>::c),
            F(1.0f / TintCoding::strength_bits) * between(strength)};
}

/// As tint_between, of a word.
template <class F>
CHIARO_INLINE Four<F> tint_of(Int<F> word) {
    using I = Int<F>;
    const auto root = [&](int shift)
                          CHIARO_INLINE_LAMBDA { return F(1.0f / 255) * to_float((word >> I(shift)) & I(255)); };
    constexpr int most = TintCoding::strength_bits;
    return {root(0), root(8), root(16), F(1.0f / most) * to_float((word >> I(TintCoding::strength_shift)) & I(most))};
}
template <class F>
CHIARO_INLINE Mask<F> is_several(Int<F> word) {
    return (word & Int<F>(TintCoding::several)) != Int<F>(0);
}

/// What a tint makes of a colour with its opacity, or of colour × extinction with that.
template <class F>
struct Tint {
    RgbaLanes<F> keep, add;

    Tint() = default;
    CHIARO_INLINE explicit Tint(const Four<F>& tint) {
        const F s = tint.d, rest = F(1) - s;
        keep = rgba_of(Vec3<F>{rest, rest, rest}, F(1));
        add = rgba_of(Vec3<F>{s * tint.a * tint.a, s * tint.b * tint.b, s * tint.c * tint.c}, F(0));
    }
    CHIARO_INLINE RgbaLanes<F> of(const RgbaLanes<F>& matter) const { return light_up(matter, keep, add); }
};

/// Nearly everywhere the eight voxels around have one tint.
template <class F>
CHIARO_INLINE RgbaLanes<F> tinted(const LabelView& labels, const Location<F>& at, const RgbaLanes<F>& matter) {
    const Int<F> word = gather_word(labels.tint, at.index);
    Four<F> tint = tint_of<F>(word);
    const Mask<F> several = is_several<F>(word);
    if (any(several)) {
        const Four<F> between = tint_between(labels, at);
        tint = {select(several, between.a, tint.a), select(several, between.b, tint.b),
                select(several, between.c, tint.c), select(several, between.d, tint.d)};
    }
    return Tint<F>(tint).of(matter);
}

/// What labels say of the cells that lanes are in: one tint, and all is shown; or what each sample must look up.
template <class F>
struct CellTint {
    Int<F> word{TintCoding::several};
    Mask<F> several = F(0) < F(1);
    Tint<F> tint{tint_of<F>(Int<F>(0))};

    /// Lanes that have come to other cells, by the cells' numbers.
    CHIARO_INLINE void enter(const LabelView& labels, Mask<F> lanes, Int<F> cell) {
        const Int<F> found = gather_word(labels.cells, typename GatherIndex<F>::type(cell));
        const Mask<F> other = lanes & (found != word);
        if (!any(other)) return;
        word = select(other, found, word);
        several = is_several<F>(word);
        tint = Tint<F>(tint_of<F>(word));
    }
};

/// What labels leave of extinction.
template <class F>
CHIARO_INLINE F left_of(const LabelView& labels, const Location<F>& at) {
    const F share = share_at(labels, at);
    if (!labels.distance || !any(gather_byte(labels.distance, at.index) != Int<F>(LabelCoding::deep))) return share;
    return share * left_at(distance_at(labels, at));
}

/// What labels make of a sample.
template <class F>
CHIARO_INLINE RgbaLanes<F> labelled(const LabelView& labels, const Location<F>& at, RgbaLanes<F> matter) {
    if (labels.distance || labels.share) matter = scale(matter, left_of(labels, at));
    return labels.tint && any(alpha_of(matter) > F(0)) ? tinted(labels, at, matter) : matter;
}

/// The border's distance, and how it grows along a way (voxels).
template <class F>
CHIARO_INLINE Two<F> border_along(const LabelView& labels, const Location<F>& at, Vec3<F> way) {
    if (!labels.distance) return {F(1), F(0)};
    VolumeView<std::uint8_t> border{};
    border.voxels = labels.distance;
    return {distance_at(labels, at), F(1 / LabelCoding::per_voxel) * dot(border.differences(at), way)};
}

/// The gradient of extinction κ that labels leave; `gradient` is that of κ. The border's own is felt two voxels deep,
/// so that even matter that is cut free is shaded as smoothly as its border is known.
template <class F>
CHIARO_INLINE Vec3<F> labelled_gradient(const LabelView& labels, const Location<F>& at, F kappa, Vec3<F> gradient) {
    if (!labels.distance) return gradient;
    const F distance = distance_at(labels, at);
    const F near = max(F(1) - F(1.0f / LabelCoding::reach) * abs(distance), F(0));
    if (!any(near > F(0))) return left_at(distance) * gradient;
    VolumeView<std::uint8_t> border{};
    border.voxels = labels.distance;
    return left_at(distance) * gradient + (kappa * near * F(1 / LabelCoding::per_voxel)) * border.differences(at);
}

/// A value as isosurfaces see it: `outside` of all of them where labels hide it.
template <class F>
CHIARO_INLINE F shown_value(const LabelView& labels, const Location<F>& at, F value, float outside) {
    if (!labels.distance || !any(gather_byte(labels.distance, at.index) != Int<F>(LabelCoding::deep))) return value;
    return select(distance_at(labels, at) < F(0), F(outside), value);
}

/// At an isosurface the gradient of what bounds it: of values, or of the border, where that is nearer than values are
/// to the surface's, from which they are `off`.
template <class F>
CHIARO_INLINE Vec3<F> surface_gradient(const LabelView& labels, const Location<F>& at, F off, Vec3<F> gradient,
                                       float outside) {
    if (!labels.distance) return gradient;
    const Mask<F> is_border = abs(distance_at(labels, at)) * sqrt(dot(gradient, gradient)) < abs(off);
    if (!any(is_border)) return gradient;
    VolumeView<std::uint8_t> border{};
    border.voxels = labels.distance;
    return select(is_border, F(outside < 0 ? 1.0f : -1.0f) * border.differences(at), gradient);
}

}  // namespace chiaro::kernel
