// One viewer's state: each verb's result, kept with the inputs that made it.
#pragma once
#include <chiaro/device.h>
#include <chiaro/scene.h>

#include <functional>
#include <string>
#include <vector>

namespace chiaro {

/// Receives a picture that a better one follows.
using Preview = std::function<void(const Image&)>;

/// Renders scenes one after the other and redoes only the verbs to the right of what changed: an edit of the transfer
/// function starts at `classify`, a camera move is `raycast` and `develop`.
class Session {
public:
    explicit Session(Device device);
    ~Session();
    Session(Session&&) noexcept;

    /// Takes the volume that later scenes show (read_volume or make_sample gave it).
    void show(Volume&& volume, Progress& progress);

    /// `preview` is handed the picture with each coarse light that comes before the finest (visibility, and each
    /// iteration of transport), while that is still being found; and with each pass of paths (reference).
    const Image& render(const Scene& scene, Progress& progress, const Preview& preview = {});
    /// What the scene's lighting method computes for the shown volume. Throws as chiaro::compute_field.
    ComputedField compute_field(const Scene& scene, Progress& progress);

    const Frame& frame() const;  ///< of the last render
    /// Of the last render or field, in order; a verb whose kept result served took 0. What a verb consists of follows
    /// it.
    const std::vector<Stage>& stages() const;
    const std::vector<std::string>& notes() const;  ///< of what was prepared: what a user should know
    Outcome outcome() const;                        ///< of the last render
    std::size_t light_bytes() const;                ///< held: what the last render's lighting prepared, and its light
    const Statistics& statistics() const;           ///< of the shown volume
    const TransferFunction& transfer_function() const;  ///< the one the last render used, window and unit applied
    const Guess& guess() const;                         ///< what the shown volume seems to be

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A whole picture in one call: read, the six verbs, done.
Image render_image(const Device& device, const Scene& scene, Progress& progress);

}  // namespace chiaro
