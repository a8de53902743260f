// The server of `chiaro view` without the tool, which takes long to compile under a sanitizer: for scripts/soak.
#include <chiaro/error.h>

#include <cstdio>

#include "server/serve.h"

int main(int argc, char** argv) {
    using namespace chiaro;
    try {
        server::ViewerOptions options;
        options.scene.emplace().volume = argc > 1 ? argv[1] : "sample:ball:32";
        options.folders = {"."};
        options.port = 0;
        options.device = Device::cpu();
        server::Viewer viewer(options);
        std::puts(viewer.url().c_str());
        std::fflush(stdout);
        viewer.run(true);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
