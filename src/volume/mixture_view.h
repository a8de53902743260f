// What a sample is made of where that is not one value looked up in one table: several channels, which mix as media do.
// Extinctions add, colours are means weighted by extinction, or the voxels' own. This is the one place that knows;
// consumers ask a volume whether it `is_mixed`, and then for its `matter_at` a place in the stead of a value.
#pragma once
#include "kernel/rgba.h"
#include "volume/label_view.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// One of the values of a voxel. All channels of a volume lie alike in memory, so a location serves all of them.
template <class Voxel>
struct ChannelView {
    VolumeView<Voxel> volume;   ///< of its own voxels alone
    RgbaTable matter;           ///< κ per mm, and colour × κ, over its stored values; of own colours κ or a colour
    const float* rise;          ///< dκ/dv, with a hair of κ, so that matter that is even has a direction, too
    const std::uint8_t* share;  ///< of 255, in bricks as labels: where it is of some labels alone; null: everywhere
    const Rgba* by_gradient;  ///< what is left of κ, and colour × that, by the factor's entries; null: colours by value

    /// κ per mm.
    template <class F>
    CHIARO_INLINE F extinction_of(F stored) const {
        return gather_float(&matter.entries->a, matter.index(stored) * Int<F>(4));
    }
};

/// Of the sum over channels: where colours stand beside extinction, their product; and what labels leave of it.
template <class F, class Voxel>
CHIARO_INLINE RgbaLanes<F> matter_of_sum(const MixtureView<Voxel>& mixture, const Location<F>& at,
                                         const RgbaLanes<F>& sum) {
    if (!mixture.own_colors) return labelled<F>(mixture.labels, at, sum);
    const F kappa = alpha_of(sum), none(0);
    return labelled<F>(mixture.labels, at, light_up(sum, Vec3<F>{kappa, kappa, kappa}, Vec3<F>{none, none, none}));
}

/// Extinction per mm (alpha), and colour × extinction: linear, or display colours as they are; not capped.
template <class F, class Voxel>
static CHIARO_NOINLINE RgbaLanes<F> mixed_matter(const VolumeView<Voxel>& volume, const Location<F>& at) {
    RgbaLanes<F> sum;
    zero(sum);
    for (std::int32_t i = 0; i < volume.mixture.count; ++i) {
        const ChannelView<Voxel>& channel = volume.mixture.channels[i];
        const F stored = channel.volume.value(at);
        RgbaLanes<F> matter = channel.matter.at(stored);
        if (channel.by_gradient)
            matter = scale(
                load_rgba(channel.by_gradient, channel.volume.factor.index(stored, channel.volume.own_gradient(at))),
                alpha_of(matter));
        else if (channel.volume.has_factor())
            matter = scale(matter, channel.volume.factor_at(at, stored));
        sum = accumulate(sum, channel.share ? share_of(channel.share, at) : F(1), matter);
    }
    return matter_of_sum(volume.mixture, at, sum);
}

/// The same of the eight voxels around a point; x, y and z are the number's bits.
template <class F>
struct EightMatters {
    RgbaLanes<F> of[8];
};
template <class F, class Voxel>
static CHIARO_NOINLINE void mixed_corners(const VolumeView<Voxel>& volume, const Location<F>& at,
                                          EightMatters<F>& sums) {
    for (auto& sum : sums.of) zero(sum);
    for (std::int32_t i = 0; i < volume.mixture.count; ++i) {
        const ChannelView<Voxel>& channel = volume.mixture.channels[i];
        const Four<Two<F>> v = channel.volume.corners(at);
        const F stored[8]{v.a.a, v.a.b, v.b.a, v.b.b, v.c.a, v.c.b, v.d.a, v.d.b};
        const F share = channel.share ? share_of(channel.share, at) : F(1);
        for (int corner = 0; corner < 8; ++corner)
            sums.of[corner] = accumulate(sums.of[corner], share, channel.matter.at(stored[corner]));
    }
    for (auto& sum : sums.of) sum = matter_of_sum(volume.mixture, at, sum);
}

/// The gradient of extinction: Σ dκ/dv ∇v, any scale. Where matter is even the channels' gradients count by their
/// extinction.
template <class F, class Voxel>
static CHIARO_NOINLINE Vec3<F> mixed_gradient(const VolumeView<Voxel>& volume, const Location<F>& at) {
    Vec3<F> sum(F(0), F(0), F(0));
    F kappa(0);
    for (std::int32_t i = 0; i < volume.mixture.count; ++i) {
        const ChannelView<Voxel>& channel = volume.mixture.channels[i];
        const F stored = channel.volume.value(at);
        const F rise = gather_float(channel.rise, channel.matter.index(stored));
        const bool by_label = volume.mixture.labels.distance || channel.share;
        if (!by_label && !any((rise < F(0)) | (rise > F(0)))) continue;
        const Vec3<F> gradient = channel.volume.own_gradient(at);
        F left = channel.volume.has_factor() ? channel.volume.factor_of(stored, gradient) : F(1);
        if (channel.share) {
            sum = mad(left * channel.extinction_of(stored), share_gradient(channel.share, at), sum);
            left = left * share_of(channel.share, at);
        }
        if (volume.mixture.labels.distance) kappa = mad(left, channel.extinction_of(stored), kappa);
        sum = mad(left * rise, gradient, sum);
    }
    return labelled_gradient(volume.mixture.labels, at, kappa, sum);
}

/// κ per mm at -1.5, -.5, 0, .5 and 1.5 times a way (voxels), for values that go on as their gradients have them.
template <class F>
struct FiveExtinctions {
    F at[5];
};
template <class F, class Voxel>
static CHIARO_NOINLINE void mixed_along(const VolumeView<Voxel>& volume, const Location<F>& at, const Vec3<F>& way,
                                        FiveExtinctions<F>& sums) {
    constexpr float steps[5]{-1.5f, -0.5f, 0, 0.5f, 1.5f};
    for (F& sum : sums.at) sum = F(0);
    for (std::int32_t i = 0; i < volume.mixture.count; ++i) {
        const ChannelView<Voxel>& channel = volume.mixture.channels[i];
        const Vec3<F> gradient = channel.volume.own_gradient(at);
        const F stored = channel.volume.value(at), rate = dot(gradient, way);
        F left = channel.volume.has_factor() ? channel.volume.factor_of(stored, gradient) : F(1);
        if (channel.share) left = left * share_of(channel.share, at);
        for (int step = 0; step < 5; ++step)
            sums.at[step] = mad(left, channel.extinction_of(mad(F(steps[step]), rate, stored)), sums.at[step]);
    }
    const LabelView& labels = volume.mixture.labels;
    if (!labels.distance && !labels.share) return;
    const F share = share_at(labels, at);
    const Two<F> border = border_along(labels, at, way);
    for (int step = 0; step < 5; ++step)
        sums.at[step] = sums.at[step] * share * left_at(mad(F(steps[step]), border.b, border.a));
}

}  // namespace chiaro::kernel
