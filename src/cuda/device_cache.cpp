#include "cuda/device_cache.h"

#include <algorithm>
#include <iterator>

namespace chiaro::cuda {
namespace {

bool is_same(const HostArray& a, const HostArray& b) {
    return a.data == b.data && a.bytes == b.bytes && !a.owner.owner_before(b.owner) && !b.owner.owner_before(a.owner);
}

}  // namespace

DeviceCache::~DeviceCache() {
    for (const Copy& copy : copies_) Stream::release_at_once(gpu_, copy.memory);
}

const std::byte* DeviceCache::of(const HostArray& array, Stream& stream) {
    std::unique_lock lock(mutex_);
    if (const std::byte* memory = kept(array)) return memory;
    lock.unlock();
    array.fetch();  // from another GPU, perhaps, whose mirror may be waiting for this one
    lock.lock();
    if (const std::byte* memory = kept(array)) return memory;
    const std::byte* memory = add(array, stream, [&](std::byte* to) { stream.upload(to, array.data, array.bytes); });
    copied_bytes_ += array.bytes;
    return memory;
}

const std::byte* DeviceCache::kept(const HostArray& array) const {
    const auto copy =
        std::find_if(copies_.begin(), copies_.end(), [&](const Copy& each) { return is_same(each.of, array); });
    return copy == copies_.end() ? nullptr : copy->memory;
}

void DeviceCache::keep(const HostArray& array, const void* made, Stream& stream) {
    const std::lock_guard lock(mutex_);
    add(array, stream, [&](std::byte* to) { stream.copy(to, made, array.bytes); });
}

std::uint64_t DeviceCache::texture(const HostArray& array, Stream& stream,
                                   const std::function<std::unique_ptr<Texture>()>& make) {
    const std::lock_guard lock(mutex_);
    for (const auto& [of, texture] : textures_)
        if (is_same(of, array)) return texture->handle();
    let_go_of_orphans(stream);
    auto made = make();
    stream.wait();  // other streams read it too
    textures_.emplace_back(array, std::move(made));
    return textures_.back().second->handle();
}

/// fill(memory)
template <class Fill>
const std::byte* DeviceCache::add(const HostArray& array, Stream& stream, const Fill& fill) {
    let_go_of_orphans(stream);
    copies_.push_back({array, static_cast<std::byte*>(nullptr)});
    std::byte*& memory = copies_.back().memory;
    try {
        memory = static_cast<std::byte*>(stream.allocate(array.bytes));
        fill(memory);
        stream.wait();  // other streams read it too
    } catch (...) {
        if (memory) stream.release(memory);
        copies_.pop_back();
        throw;
    }
    return memory;
}

/// Whoever read them has waited for that with their owner in hand.
void DeviceCache::let_go_of_orphans(Stream& stream) {
    std::erase_if(copies_, [&](const Copy& copy) {
        if (!copy.of.owner.expired()) return false;
        stream.release(copy.memory);
        return true;
    });
    std::erase_if(textures_, [](const auto& texture) { return texture.first.owner.expired(); });
}

std::size_t DeviceCache::held_bytes() const {
    const std::lock_guard lock(mutex_);
    std::size_t bytes = 0;
    for (const Copy& copy : copies_) bytes += copy.of.bytes;
    return bytes;
}

std::shared_ptr<const DeferredDownload> keep_resident(const std::shared_ptr<Stream>& stream, const HostArray& array,
                                                      const void* made, void* to) {
    stream->device_cache()->keep(array, made, *stream);
    return std::make_shared<const DeferredDownload>([stream, array, to] {
        stream->download(to, stream->device_cache()->of(array, *stream), array.bytes);
        stream->wait();
    });
}

const std::byte* Views::on_gpu(const void* pointer) {
    if (!pointer) return nullptr;
    const HostArray* array = arrays_.holding(pointer);
    if (!array) throw Error(ErrorCode::internal, "a kernel points into memory that is not told of");
    const std::ptrdiff_t offset = static_cast<const std::byte*>(pointer) - static_cast<const std::byte*>(array->data);
    if (array->is_shared) return stream_.device_cache()->of(*array, stream_) + offset;
    auto own = std::find_if(own_.begin(), own_.end(), [&](const Own& each) { return each.of == array; });
    if (own == own_.end()) {
        own_.push_back({array, Array<std::byte>(stream_, array->bytes)});
        own = std::prev(own_.end());
        stream_.upload(own->memory.data(), array->data, array->bytes);
    }
    return own->memory.data() + offset;
}

}  // namespace chiaro::cuda
