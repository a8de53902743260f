#include "classify/medium.h"

namespace chiaro {

Medium classify(const DeviceVolume& volume, const TransferFunction& tf, const Shape& shape) {
    validate(tf);
    auto data = std::make_shared<Medium::Data>();
    data->volume = volume;
    data->color = shape.color;
    data->table = make_optical_table(volume.data(), tf, shape);
    data->cells =
        make_occupancy(volume.data().cells, data->table, volume.data().device.threads, data->occupied_fraction);
    return Medium(std::move(data));
}

double Medium::occupied_fraction() const { return data().occupied_fraction; }

}  // namespace chiaro
