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
CHIARO_INLINE F share_at(const LabelView& labels, const Location<F>& at) {
    return labels.share ? F(1.0f / 255) * byte_at(labels.share, at) : F(1);
}

/// Of extinction and colour × extinction.
template <class F>
CHIARO_INLINE RgbaLanes<F> tinted(const LabelView& labels, const Location<F>& at, const RgbaLanes<F>& matter) {
    constexpr Distances beside{0, brick_row, brick_slice, brick_slice + brick_row};
    const Four<Four<F>> a = gather_bytes(labels.tint, at.index, beside),
                        b = gather_bytes(labels.tint + 1, at.index, beside);
    const auto between = [&](auto channel) CHIARO_INLINE_LAMBDA {
        const F near = lerp(lerp(a.a.*channel, b.a.*channel, at.t.x), lerp(a.b.*channel, b.b.*channel, at.t.x), at.t.y),
                far = lerp(lerp(a.c.*channel, b.c.*channel, at.t.x), lerp(a.d.*channel, b.d.*channel, at.t.x), at.t.y);
        return F(1.0f / 255) * lerp(near, far, at.t.z);
    };
    const F r = between(&Four<F>::a), g = between(&Four<F>::b), b2 = between(&Four<F>::c), s = between(&Four<F>::d);
    const F rest = F(1) - s;
    return light_up(matter, Vec3<F>{rest, rest, rest}, Vec3<F>{s * r * r, s * g * g, s * b2 * b2});
}

/// What labels leave of extinction.
template <class F>
CHIARO_INLINE F left_of(const LabelView& labels, const Location<F>& at) {
    const F share = share_at(labels, at);
    return labels.distance ? share * left_at(distance_at(labels, at)) : share;
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
    VolumeView<std::uint8_t> border{};
    border.voxels = labels.distance;
    const F distance = distance_at(labels, at);
    const F near = max(F(1) - F(1.0f / LabelCoding::reach) * abs(distance), F(0));
    return left_at(distance) * gradient + (kappa * near * F(1 / LabelCoding::per_voxel)) * border.differences(at);
}

}  // namespace chiaro::kernel
