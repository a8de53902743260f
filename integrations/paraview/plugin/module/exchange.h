// Chiaro's Exchange over the processes of ParaView's server.
#pragma once
#include <chiaro/exchange.h>

#include <memory>

namespace chiaro::from_paraview {

/// Of the global controller; null: there is one process.
std::shared_ptr<Exchange> ranks();

}  // namespace chiaro::from_paraview
