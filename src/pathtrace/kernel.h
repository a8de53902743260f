// The path tracer: light's ways followed backwards from the eye, one path at a time, or sixteen, each at its own stage.
#pragma once
#include "illumination/floor/floor_view.h"
#include "kernel/launch.h"
#include "kernel/queue.h"
#include "pathtrace/cloud.h"
#include "pathtrace/light_view.h"
#include "pathtrace/surface_cloud.h"
#include "pathtrace/surfaces.h"
#include "raycast/ray_bounds.h"

namespace chiaro::kernel {

/// One path for each pixel of a tile.
struct PathTask {
    Tile tile;
    std::int32_t sample;
    Rgba* results;  ///< of the tile, row by row: light, and whether anything was met
};

struct Box {
    Float3 low, high;  ///< voxels
};

/// World and grid: columns of the matrices between mm and voxels, without shift.
struct AxesView {
    Float3 voxel_x, voxel_y, voxel_z;  ///< voxels per mm along the world's axes
    Float3 world_x, world_y, world_z;  ///< mm per voxel along the grid's axes

    template <class F>
    CHIARO_INLINE Vec3<F> to_voxels(Vec3<F> world) const {
        return mad(world.x, Vec3<F>(voxel_x), mad(world.y, Vec3<F>(voxel_y), world.z * Vec3<F>(voxel_z)));
    }
    template <class F>
    CHIARO_INLINE Vec3<F> to_world(Vec3<F> voxels) const {
        return mad(voxels.x, Vec3<F>(world_x), mad(voxels.y, Vec3<F>(world_y), voxels.z * Vec3<F>(world_z)));
    }
};

/// Where the paths of a frame begin: at the camera's pixels, or at a point for each of them.
struct StartView {
    CameraView camera;
    const float *x = nullptr, *y = nullptr, *z = nullptr;  ///< voxels, row by row of the frame; none: the camera

    CHIARO_INLINE bool at_points() const { return x != nullptr; }
    template <class F>
    CHIARO_INLINE Vec3<F> point(Int<F> pixel) const {
        return {gather_float(x, pixel), gather_float(y, pixel), gather_float(z, pixel)};
    }
};

/// L = ∫ κ E T dt and what further scattering adds. At each collision light is looked for twice - towards the probe's
/// brightest parts, and along the way that the path takes on - and both answers are weighed by the balance heuristic
/// (Veach and Guibas 1995). `Matter` says what is met: a Cloud or Surfaces.
template <class Matter>
struct PathKernel {
    Matter matter;
    StartView start;
    AxesView axes;
    Box seen, lit;  ///< what the camera looks into; what light passes through
    ClipView clip_view;
    ProbeLightView probe;
    FloorView floor;
    std::int32_t floor_material;  ///< its entry in the tables of colours
    std::int32_t max_scatterings;
    float start_mm;          ///< light paths begin this far from where they scatter
    float normal_offset_mm;  ///< and so far above a surface
    std::int32_t sub_pixels;
    std::int32_t pixel_key, sample_key;  ///< from the seed
    std::int32_t width;                  ///< of the frame

    /// Follows a path for each pixel of the tile; returns the number of collisions, tentative ones too, per lane.
    template <class F>
    CHIARO_INLINE Int<F> operator()(const PathTask& task) const {
        using I = Int<F>;
        const std::int32_t columns = task.tile.x1 - task.tile.x0, count = columns * (task.tile.y1 - task.tile.y0);
        constexpr int few = LaneTraits<F>::count / 4, many = LaneTraits<F>::count / 2;
        Path<F> path;
        I collisions(0);
        std::int32_t next = refill(path, task, columns, 0, count);
        for (;;) {
            Mask<F> going = at_stage(path, travelling);
            while (any(going)) {
                matter.travel(path);
                going = at_stage(path, travelling);
                if (kernel::count(going) <= few) break;
            }
            const Mask<F> meeting = at_stage(path, met);
            if (any(meeting)) {
                collisions += select(meeting, I(1), I(0));
                matter.meet(meeting, path);
                if (floor.on) leave_floor(meeting, path);
            }
            const Mask<F> waiting = (path.stage >= I(collided)) & (path.stage <= I(ended));
            const Mask<F> busy = path.stage <= I(met);
            if (!any(waiting)) {
                if (!any(busy)) return collisions;
                continue;
            }
            if (any(busy) && kernel::count(waiting) < many) continue;
            scatter(path);
            arrive(path);
            turn(path);
            const Mask<F> over = at_stage(path, ended);
            if (!any(over)) continue;
            hand_over(over, path.number, path.light, select(path.scatterings > I(0), F(1), F(0)), task.results);
            path.stage = select(over, I(idle), path.stage);
            next = refill(path, task, columns, next, count);
        }
    }

private:
    /// Idle lanes take the next pixels of the queue.
    template <class F>
    CHIARO_INLINE std::int32_t refill(Path<F>& path, const PathTask& task, std::int32_t columns, std::int32_t next,
                                      std::int32_t count) const {
        using I = Int<F>;
        Mask<F> fresh = at_stage(path, idle);
        const I number = I(next) + set_before(fresh);
        fresh = fresh & (number < I(count));
        if (!any(fresh)) return next;
        const I row = truncate((to_float(number) + F(0.5f)) * F(1 / float(columns))),
                column = number - row * I(columns);
        begin(path, fresh, number, I(task.tile.x0) + column, I(task.tile.y0) + row, task.sample);
        return next + kernel::count(fresh);
    }

    template <class F>
    CHIARO_INLINE void begin(Path<F>& path, Mask<F> fresh, Int<F> number, Int<F> x, Int<F> y,
                             std::int32_t sample) const {
        using I = Int<F>;
        const RandomKey<F> key = random_key<F>(wrapping_mad(y, I(width), wrapping_mad(x, I(1), I(pixel_key))),
                                               wrapping_mad(I(sample), I(1), I(sample_key)));
        path.key = {select(fresh, key.pixel, path.key.pixel), select(fresh, key.sample, path.key.sample)};
        path.number = select(fresh, number, path.number);
        path.dimension = select(fresh, I(0), path.dimension);
        path.scatterings = select(fresh, I(0), path.scatterings);
        path.to_light = select(fresh, I(0), path.to_light);
        path.on_surface = select(fresh, F(0), path.on_surface);
        path.shining = select(fresh, F(0), path.shining);
        path.colour = select<F>(fresh, {F(1), F(1), F(1)}, path.colour);
        path.throughput = select<F>(fresh, {F(1), F(1), F(1)}, path.throughput);
        path.light = select<F>(fresh, {F(0), F(0), F(0)}, path.light);
        if (start.at_points()) return begin_at(start.template point<F>(y * I(width) + x), path, fresh);
        const SubPixel offset = sub_pixel(sample % sub_pixels, sub_pixels);
        const F column = to_float(x) + F(offset.x), row = to_float(y) + F(offset.y);
        Ray<F> ray = start.camera.ray(column, row);
        if (start.camera.lens_mm > 0) {
            const Draw<F> lens = draw_for(fresh, path);
            ray = ray_through_lens(start.camera, column, row, lens.a, lens.b);
        }
        path.heading = select(fresh, axes.to_world(ray.direction), path.heading);
        set_off(path, fresh, ray, F(0), seen);
    }

    /// J, the mean of the light from all around, is what scatters at a point of albedo 1 about an axis that is drawn
    /// evenly: whatever the matter's phase function, the next direction is then even over the sphere.
    template <class F>
    CHIARO_INLINE void begin_at(Vec3<F> point, Path<F>& path, Mask<F> fresh) const {
        const Draw<F> numbers = draw_for(fresh, path);
        const Vec3<F> axis = around<F>({F(0), F(0), F(1)}, mad(F(2), numbers.a, F(-1)), numbers.b);
        path.scatterings = select(fresh, Int<F>(1), path.scatterings);
        path.place = select(fresh, point, path.place);
        path.heading = select(fresh, axis, path.heading);
        path.normal = select(fresh, axis, path.normal);
        path.stage = select(fresh, Int<F>(turning), path.stage);
        if (!probe.even) look_for_light(path, fresh);
    }

    /// Takes a straight way through the box, from `from_mm` on.
    template <class F>
    CHIARO_INLINE void set_off(Path<F>& path, Mask<F> lanes, const Ray<F>& ray, F from_mm, const Box& box) const {
        Interval<F> way = intersect(ray, box.low, box.high);
        const Mask<F> from_outside = way.near > from_mm;
        way.near = max(way.near, from_mm);
        Cut<F> cut = clip(clip_view, ray, way);
        if constexpr (Matter::has_cuts)
            if (const Mask<F> enters = from_outside & !cut.open; any(enters))
                enter_by_border(ray, box.low, box.high, way.near, enters, cut);
        const Vec3<F> d = ray.direction;
        if (floor.on) end_at_floor(ray, way);
        path.origin = select(lanes, mad(way.near, d, ray.origin), path.origin);
        path.direction = select(lanes, d, path.direction);
        path.inverse = select<F>(
            lanes, {F(1) / away_from_zero(d.x), F(1) / away_from_zero(d.y), F(1) / away_from_zero(d.z)}, path.inverse);
        const F length = way.far - way.near;
        path.t = select(lanes, F(0), path.t);
        path.end = select(lanes, length, path.end);
        path.stage = select(lanes, select(length > F(0), Int<F>(travelling), Int<F>(escaped)), path.stage);
        matter.begin(lanes, cut, path);
    }

    /// What lies behind the floor is not met; a way that comes to it first has no length.
    template <class F>
    CHIARO_INLINE void end_at_floor(const Ray<F>& ray, Interval<F>& way) const {
        const F to_floor = floor.distance(ray);
        const Mask<F> is_first = to_floor < way.near;
        way.near = select(is_first, F(0), way.near);
        way.far = select(is_first, F(0), min(way.far, to_floor));
    }

    /// From where the path last collided.
    template <class F>
    CHIARO_INLINE void set_off_towards(Path<F>& path, Mask<F> lanes, Vec3<F> direction) const {
        Vec3<F> from = path.place;
        if constexpr (Matter::has_normals) from = mad(F(normal_offset_mm), axes.to_voxels(path.normal), from);
        set_off(path, lanes, Ray<F>{from, axes.to_voxels(direction)}, F(start_mm), lit);
    }

    /// Collided paths lose what is absorbed and look towards the light; past the last collision they end.
    template <class F>
    CHIARO_INLINE void scatter(Path<F>& path) const {
        using I = Int<F>;
        Mask<F> lanes = at_stage(path, collided);
        if (!any(lanes)) return;
        Mask<F> counted = lanes;  // the floor is a part of the light's world, but where the eye sees it
        if (floor.on) counted = counted & ((path.on_surface != F(on_floor)) | (path.scatterings == I(0)));
        const Mask<F> spent = counted & (path.scatterings >= I(max_scatterings));
        path.stage = select(spent, I(ended), path.stage);
        lanes = lanes & !spent;
        path.scatterings += select(lanes & counted, I(1), I(0));
        path.place = select(lanes, mad(path.t, path.direction, path.origin), path.place);
        absorb(path, lanes);
        const Mask<F> goes_on = max(path.throughput.x, max(path.throughput.y, path.throughput.z)) > F(0);
        path.stage = select(lanes, select(goes_on, I(turning), I(ended)), path.stage);
        if (!probe.even) look_for_light(path, lanes & goes_on);
    }

    /// Where the albedo leaves less than a quarter a path goes on with four times that probability (Russian roulette).
    template <class F>
    CHIARO_INLINE void absorb(Path<F>& path, Mask<F> lanes) const {
        constexpr float worth = 0.25f;
        path.colour = select(lanes, matter.colours.template at<F>(path.material), path.colour);
        const Vec3<F> white(F(1), F(1), F(1));
        const Vec3<F> left = scaled(path.throughput, mad(path.shining, white - path.colour, path.colour));
        const F most = max(left.x, max(left.y, left.z));
        const Mask<F> weak = lanes & (most < F(worth));
        if (any(weak)) {
            const Mask<F> goes_on = draw_for(weak, path).a * F(worth) < most;
            const F factor = select(goes_on, F(worth) / max(most, F(1e-30f)), F(0));
            path.throughput = select(weak, factor * path.throughput, path.throughput);
        }
    }

    /// A way towards a bright part of the probe. What arrives counts f L / (p_light + p_f): the balance heuristic's
    /// share of f L / p_light, f being the density that the path's own direction is drawn with. Of several directions
    /// one is taken, in proportion to what would arrive if all were clear, and counts for their mean (Talbot et al.
    /// 2005).
    template <class F>
    CHIARO_INLINE void look_for_light(Path<F>& path, Mask<F> lanes) const {
        if (!any(lanes)) return;
        F sum(0), taken(0);
        Vec3<F> direction = path.heading, offer(F(0), F(0), F(0));
        for (int candidate = 0; candidate < Matter::light_candidates; ++candidate) {
            const Draw<F> bin = draw_for(lanes, path), within = draw_for(lanes, path);
            const F u = candidate > 0 ? draw_for(lanes, path).a : F(0);
            const auto drawn = probe.template towards<F>(bin, within);
            const Scattered<F> found = scattered(path, drawn.direction);
            Mask<F> counts = lanes & (found.coloured + found.shine > F(0));
            if (floor.on) counts = counts & !falls(drawn.direction);
            const F weight = F(1) / max(found.density + drawn.light.density, F(1e-30f));
            const Vec3<F> reflected = scaled(path.throughput, answer(path, found.coloured, found.shine));
            const Vec3<F> offered = weight * scaled(reflected, drawn.light.radiance);
            const F size = select(counts, offered.x + offered.y + offered.z, F(0));
            sum = sum + size;
            const Mask<F> takes = counts & (u * sum < size);
            taken = select(takes, size, taken);
            direction = select(takes, drawn.direction, direction);
            offer = select(takes, offered, offer);
        }
        lanes = lanes & (taken > F(0));
        const F factor = sum / (F(float(Matter::light_candidates)) * max(taken, F(1e-30f)));
        path.offer = select(lanes, factor * offer, path.offer);
        path.transmittance = select(lanes, F(1), path.transmittance);
        path.to_light = select(lanes, Int<F>(1), path.to_light);
        set_off_towards(path, lanes, direction);
    }

    /// Paths that nothing stops see the probe; the eye's own way ends there without light.
    template <class F>
    CHIARO_INLINE void arrive(Path<F>& path) const {
        using I = Int<F>;
        const Mask<F> lanes = at_stage(path, escaped);
        if (!any(lanes)) return;
        const Mask<F> asked = lanes & (path.to_light == I(1));
        Mask<F> own = lanes & !asked;
        path.light = select(asked, mad(path.transmittance, path.offer, path.light), path.light);
        path.to_light = select(asked, I(0), path.to_light);
        path.stage = select(asked, I(turning), select(own, I(ended), path.stage));
        if (floor.on) own = own & !fall(path, own);
        const Mask<F> lit_ones = own & (path.scatterings > I(0));
        if (!any(lit_ones)) return;
        const auto light = probe.template at<F>(path.heading);
        const F weight = probe.even ? F(1) : path.density / max(path.density + light.density, F(1e-30f));
        path.light = select(lit_ones, path.light + weight * scaled(path.throughput, light.radiance), path.light);
    }

    template <class F>
    CHIARO_INLINE Mask<F> falls(Vec3<F> direction) const {
        return dot(Vec3<F>(floor.up), direction) < F(0);
    }

    /// Of paths that leave downwards those that come to the floor collide with it; the eye sees as much of it as is
    /// shown. All that fall are returned: below there is no light.
    template <class F>
    CHIARO_INLINE Mask<F> fall(Path<F>& path, Mask<F> own) const {
        const Mask<F> falling = own & falls(path.heading);
        if (!any(falling)) return falling;
        const F t = floor.distance(Ray<F>{path.origin, path.direction});
        Mask<F> meets = falling & (t < F(1e30f));
        const Mask<F> seen = meets & (path.scatterings == Int<F>(0));
        if (any(seen)) {
            const Vec3<F> p = mad(t, path.direction, path.origin);
            const Mask<F> is_there = draw_for(seen, path).a < floor.share(floor.u(p), floor.v(p));
            meets = meets & (is_there | (path.scatterings > Int<F>(0)));
        }
        path.t = select(meets, t, path.t);
        path.normal = select(meets, Vec3<F>(floor.up), path.normal);
        path.on_surface = select(meets, F(on_floor), path.on_surface);
        path.shining = select(meets, F(0), path.shining);
        path.material = select(meets, Int<F>(floor_material), path.material);
        path.stage = select(meets, Int<F>(collided), path.stage);
        return falling;
    }

    /// What collides with particles after the floor is no longer on it.
    template <class F>
    CHIARO_INLINE void leave_floor(Mask<F> meeting, Path<F>& path) const {
        const Mask<F> left = meeting & at_stage(path, collided) & (path.on_surface == F(on_floor));
        path.on_surface = select(left, F(0), path.on_surface);
    }

    /// The floor is matte.
    template <class F>
    CHIARO_INLINE Scattered<F> scattered(const Path<F>& path, Vec3<F> direction) const {
        const Scattered<F> found = matter.scattered(path, direction);
        if (!floor.on) return found;
        const Mask<F> of_floor = path.on_surface == F(on_floor);
        const F matte = max(dot(Vec3<F>(floor.up), direction), F(0)) * F(0.318309886f);
        return {select(of_floor, matte, found.coloured), select(of_floor, F(0), found.shine),
                select(of_floor, matte, found.density)};
    }
    template <class F>
    CHIARO_INLINE Vec3<F> direction(const Path<F>& path, const Draw<F>& numbers) const {
        const Vec3<F> found = matter.direction(path, numbers);
        if (!floor.on) return found;
        return select(path.on_surface == F(on_floor), around(Vec3<F>(floor.up), sqrt(numbers.a), numbers.b), found);
    }

    /// What the matter makes of white light.
    template <class F>
    static CHIARO_INLINE Vec3<F> answer(const Path<F>& path, F coloured, F shine) {
        return mad(coloured, path.colour, Vec3<F>(shine, shine, shine));
    }

    template <class F>
    CHIARO_INLINE void turn(Path<F>& path) const {
        const Mask<F> lanes = at_stage(path, turning);
        if (!any(lanes)) return;
        const Draw<F> numbers = draw_for(lanes, path);
        const Vec3<F> direction = this->direction(path, numbers);
        const Scattered<F> found = scattered(path, direction);
        const F inverse = F(1) / max(found.density, F(1e-30f));
        const F coloured = select(found.coloured == found.density, F(1), found.coloured * inverse);
        const Mask<F> goes_on = lanes & (found.coloured + found.shine > F(0));
        path.stage = select(lanes & !goes_on, Int<F>(ended), path.stage);
        const Vec3<F> throughput = scaled(path.throughput, answer(path, coloured, found.shine * inverse));
        path.throughput = select(goes_on, throughput, path.throughput);
        path.density = select(goes_on, found.density, path.density);
        path.heading = select(goes_on, direction, path.heading);
        set_off_towards(path, goes_on, direction);
    }
};

}  // namespace chiaro::kernel
