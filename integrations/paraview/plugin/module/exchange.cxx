#include "exchange.h"

#include <cstring>

#include "vtkCommunicator.h"
#include "vtkMultiProcessController.h"

namespace chiaro::from_paraview {
namespace {

class ControllerExchange : public Exchange {
public:
    explicit ControllerExchange(vtkMultiProcessController& controller) : controller_(controller) {}
    int rank() const override { return controller_.GetLocalProcessId(); }
    int size() const override { return controller_.GetNumberOfProcesses(); }
    void sum(std::span<std::int64_t> numbers) override {
        std::vector<long long> mine(numbers.begin(), numbers.end()), all(mine.size());
        controller_.GetCommunicator()->AllReduce(mine.data(), all.data(), vtkIdType(mine.size()),
                                                 vtkCommunicator::SUM_OP);
        std::copy(all.begin(), all.end(), numbers.begin());
    }
    void sum(std::span<float> numbers) override { reduce(numbers, vtkCommunicator::SUM_OP); }
    void largest(std::span<float> numbers) override { reduce(numbers, vtkCommunicator::MAX_OP); }
    void smallest(std::span<float> numbers) override { reduce(numbers, vtkCommunicator::MIN_OP); }
    std::vector<std::vector<std::byte>> gather(std::span<const std::byte> mine) override {
        vtkCommunicator& communicator = *controller_.GetCommunicator();
        const auto count = std::size_t(size());
        const vtkIdType length = vtkIdType(mine.size());
        std::vector<vtkIdType> lengths(count), offsets(count);
        communicator.AllGather(&length, lengths.data(), 1);
        vtkIdType total = 0;
        for (std::size_t rank = 0; rank < count; ++rank) offsets[rank] = total, total += lengths[rank];
        std::vector<char> all(std::size_t(total) + 1);
        communicator.AllGatherV(reinterpret_cast<const char*>(mine.data()), all.data(), length, lengths.data(),
                                offsets.data());
        std::vector<std::vector<std::byte>> blocks;
        for (std::size_t rank = 0; rank < count; ++rank) {
            const auto* first = reinterpret_cast<const std::byte*>(all.data() + offsets[rank]);
            blocks.emplace_back(first, first + lengths[rank]);
        }
        return blocks;
    }
    void broadcast(std::span<std::byte> bytes) override {
        controller_.Broadcast(reinterpret_cast<char*>(bytes.data()), vtkIdType(bytes.size()), 0);
    }

private:
    void reduce(std::span<float> numbers, int operation) {
        const std::vector<float> mine(numbers.begin(), numbers.end());
        controller_.GetCommunicator()->AllReduce(mine.data(), numbers.data(), vtkIdType(mine.size()), operation);
    }

    vtkMultiProcessController& controller_;
};

}  // namespace

std::shared_ptr<Exchange> ranks() {
    vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
    if (!controller || controller->GetNumberOfProcesses() < 2) return nullptr;
    static const auto made = std::make_shared<ControllerExchange>(*controller);
    return made;
}

}  // namespace chiaro::from_paraview
