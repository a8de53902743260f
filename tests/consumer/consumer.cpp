// A program of someone else's: a picture through the public headers alone.
#include <chiaro/chiaro.h>

int main(int, char** arguments) {
    chiaro::Scene scene;
    scene.volume = "sample:ball:32";
    scene.width = 64;
    scene.height = 48;
    chiaro::Progress progress;
    const chiaro::Image image = chiaro::render_image(chiaro::Device::cpu(), scene, progress);
    chiaro::write_png(image, arguments[1]);
    try {  // an error crosses the border of the library
        chiaro::make_sample("none");
        return 1;
    } catch (const chiaro::Error& error) {
        return error.code() == chiaro::ErrorCode::usage ? 0 : 2;
    }
}
