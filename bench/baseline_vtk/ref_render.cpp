// The reference that pictures are judged by: brute force in double precision, no acceleration, no early termination, a
// continuous transfer function. Writes float RGB, row 0 on top.
// ref_render --scene S.json --volume V.nrrd --out F [--size 256x192] [--step 0.05] [--shade 0|1]; raw NRRD only
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <sstream>
#include <thread>
#include <vector>

#include "scene.h"

namespace {

using namespace baseline;
using V3 = std::array<double, 3>;

V3 operator+(V3 a, V3 b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
V3 operator-(V3 a, V3 b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
V3 operator*(double s, V3 a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(V3 a, V3 b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
V3 cross(V3 a, V3 b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
V3 normalized(V3 a) { return 1 / std::sqrt(dot(a, a)) * a; }

struct Volume {
    int n[3] = {0, 0, 0};
    V3 spacing{1, 1, 1};
    std::vector<float> voxels;

    float at(int i, int j, int k) const { return voxels[(std::size_t(k) * n[1] + j) * n[0] + i]; }
    V3 extent() const { return {(n[0] - 1) * spacing[0], (n[1] - 1) * spacing[1], (n[2] - 1) * spacing[2]}; }

    /// Central differences, one-sided at the border but over the same length.
    V3 gradient(int i, int j, int k) const {
        const auto in = [&](int axis, int m) { return std::clamp(m, 0, n[axis] - 1); };
        return {(at(in(0, i + 1), j, k) - at(in(0, i - 1), j, k)) / (2 * spacing[0]),
                (at(i, in(1, j + 1), k) - at(i, in(1, j - 1), k)) / (2 * spacing[1]),
                (at(i, j, in(2, k + 1)) - at(i, j, in(2, k - 1))) / (2 * spacing[2])};
    }
};

/// Trilinear weights of a position's eight neighbours.
struct Cell {
    int i, j, k;
    double weight[8];

    Cell(const Volume& v, V3 p) {
        int corner[3];
        double f[3];
        for (int a = 0; a < 3; ++a) {
            const double q = std::clamp(p[a] / v.spacing[a], 0.0, v.n[a] - 1.000001);
            corner[a] = int(q), f[a] = q - corner[a];
        }
        i = corner[0], j = corner[1], k = corner[2];
        for (int b = 0; b < 8; ++b)
            weight[b] = (b & 1 ? f[0] : 1 - f[0]) * (b & 2 ? f[1] : 1 - f[1]) * (b & 4 ? f[2] : 1 - f[2]);
    }
    double value(const Volume& v) const {
        double sum = 0;
        for (int b = 0; b < 8; ++b) sum += weight[b] * v.at(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2));
        return sum;
    }
    V3 gradient(const Volume& v) const {
        V3 sum{0, 0, 0};
        for (int b = 0; b < 8; ++b) sum = sum + weight[b] * v.gradient(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2));
        return sum;
    }
};

template <class Voxel>
void read_voxels(std::istream& stream, std::vector<float>& voxels) {
    std::vector<Voxel> stored(voxels.size());
    stream.read(reinterpret_cast<char*>(stored.data()), std::streamsize(stored.size() * sizeof(Voxel)));
    std::copy(stored.begin(), stored.end(), voxels.begin());
}

Volume read_volume(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) fail("cannot read " + path);
    Volume v;
    std::string type, encoding;
    for (std::string line; std::getline(stream, line) && !line.empty();) {
        const std::size_t colon = line.find(": ");
        if (colon == line.npos) continue;
        std::istringstream value(line.substr(colon + 2));
        const std::string key = line.substr(0, colon);
        if (key == "type") type = value.str();
        if (key == "encoding") value >> encoding;
        if (key == "sizes") value >> v.n[0] >> v.n[1] >> v.n[2];
        if (key == "spacings") value >> v.spacing[0] >> v.spacing[1] >> v.spacing[2];
        if (key == "space directions") {  // of an axis-aligned volume: its spacing
            std::string text = value.str();
            std::replace_if(
                text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
            std::istringstream numbers(text);
            for (int a = 0; a < 3; ++a) {
                V3 d;
                numbers >> d[0] >> d[1] >> d[2];
                v.spacing[a] = std::sqrt(dot(d, d));
            }
        }
    }
    if (encoding != "raw") fail(path + ": only raw NRRD is read");
    v.voxels.resize(std::size_t(v.n[0]) * v.n[1] * v.n[2]);
    if (type == "unsigned char" || type == "uint8")
        read_voxels<std::uint8_t>(stream, v.voxels);
    else if (type == "unsigned short" || type == "uint16")
        read_voxels<std::uint16_t>(stream, v.voxels);
    else if (type == "short" || type == "int16")
        read_voxels<std::int16_t>(stream, v.voxels);
    else if (type == "float")
        read_voxels<float>(stream, v.voxels);
    else
        fail(path + ": voxels of type " + type + " are not read");
    return v;
}

struct Point {
    double value;
    V3 rgb;
    double opacity;
};

struct TransferFunction {
    std::vector<Point> points;
    double unit;

    explicit TransferFunction(const Json& json) : unit(json["opacity_unit_distance"]) {
        for (const Json& p : json["points"]) points.push_back({p["value"], p["rgb"].get<V3>(), p["opacity"]});
    }
    Point operator()(double value) const {
        if (value <= points.front().value) return points.front();
        if (value >= points.back().value) return points.back();
        std::size_t i = 1;
        while (points[i].value < value) ++i;
        const Point &a = points[i - 1], &b = points[i];
        const double t = (value - a.value) / (b.value - a.value);
        return {value, a.rgb + t * (b.rgb - a.rgb), a.opacity + t * (b.opacity - a.opacity)};
    }
};

struct Scene {
    Volume volume;
    TransferFunction tf;
    bool shade;
    double ambient, diffuse, specular, power;
    double step;
    V3 eye, forward, right, up;
    double half_height;

    Scene(const Json& json, Options& o)
        : volume(read_volume(o["volume"])), tf(json["transfer_function"]), shade(o["shade"] == "1") {
        const Json& s = json["shading"];
        ambient = s["ambient"], diffuse = s["diffuse"], specular = s["specular"], power = s["specular_power"];
        step = std::stod(o["step"]) * *std::min_element(volume.spacing.begin(), volume.spacing.end());
        eye = orbit_eye(json["camera"], volume.extent(), 0);
        forward = normalized(0.5 * volume.extent() - eye);
        right = normalized(cross(forward, {0, 0, 1}));
        up = cross(right, forward);
        half_height = std::tan(json["camera"]["view_angle_deg"].get<double>() * M_PI / 360);
    }

    V3 lit(const Cell& cell, V3 rgb) const {
        const V3 g = cell.gradient(volume);
        const double length = std::sqrt(dot(g, g));
        if (!(length > 1e-12)) return ambient * rgb;
        const double n_l = std::abs(dot(g, forward)) / length, highlight = specular * std::pow(n_l, power);
        return (ambient + diffuse * n_l) * rgb + V3{highlight, highlight, highlight};
    }

    V3 color(V3 direction) const {
        double near = 0, far = 1e30;
        const V3 extent = volume.extent();
        for (int a = 0; a < 3; ++a) {
            const double d = std::abs(direction[a]) < 1e-300 ? 1e-300 : direction[a];
            const double p = -eye[a] / d, q = (extent[a] - eye[a]) / d;
            near = std::max(near, std::min(p, q)), far = std::min(far, std::max(p, q));
        }
        V3 sum{0, 0, 0};
        if (far <= near) return sum;
        double transmittance = 1;
        const int count = int(std::ceil((far - near) / step));
        const double h = (far - near) / count;
        for (int k = 0; k < count; ++k) {
            const Cell cell(volume, eye + (near + (k + 0.5) * h) * direction);
            const Point p = tf(cell.value(volume));
            if (p.opacity <= 0) continue;
            const double alpha = p.opacity >= 1 ? 1 : 1 - std::pow(1 - p.opacity, h / tf.unit);
            sum = sum + transmittance * alpha * (shade ? lit(cell, p.rgb) : p.rgb);
            transmittance *= 1 - alpha;
        }
        return sum;
    }
};

}  // namespace

int main(int argc, char** argv) {
    Options o = read_options(argc, argv, {{"size", "256x192"}, {"step", "0.05"}, {"shade", "1"}});
    const Scene scene(read_json(o["scene"]), o);
    const auto [width, height] = read_size(o["size"]);
    std::vector<float> pixels(std::size_t(width) * height * 3);
    const auto rows = [&, width = width, height = height](int first, int stride) {
        for (int y = first; y < height; y += stride)
            for (int x = 0; x < width; ++x) {
                const double px = ((x + 0.5) / width * 2 - 1) * scene.half_height * width / height;
                const double py = (1 - (y + 0.5) / height * 2) * scene.half_height;
                const V3 rgb = scene.color(normalized(scene.forward + px * scene.right + py * scene.up));
                std::copy(rgb.begin(), rgb.end(), &pixels[3 * (std::size_t(y) * width + x)]);
            }
    };
    const int threads = std::max(1, int(std::thread::hardware_concurrency()));
    std::vector<std::jthread> workers;
    for (int t = 0; t < threads; ++t) workers.emplace_back(rows, t, threads);
    workers.clear();
    std::ofstream(o["out"], std::ios::binary)
        .write(reinterpret_cast<const char*>(pixels.data()), std::streamsize(pixels.size() * sizeof(float)));
}
