// chiaro view: a page that explores a volume, served to the browser.
#include <chiaro/error.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>

#include "command.h"
#include "interrupt.h"
#include "paging_options.h"
#include "scene_source.h"
#include "server/serve.h"

namespace chiaro::cli {
namespace {

struct ViewOptions {
    SceneSource source;
    std::optional<int> port;
    std::string host = "127.0.0.1";
    bool no_open = false;
    double max_upload = 4;  // GiB
    std::string base_path = "/";
    std::vector<std::string> embed_from;
    PagingOptions paging;
    SettingFlags flags;
    CommonOptions common;
};

bool has_display() { return std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY"); }

/// Nothing is said where that fails: the address is on the terminal.
void open_browser(std::string url) {
    std::string program = "xdg-open";
    char* arguments[] = {program.data(), url.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", 0, 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1, 0);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0);
    pid_t child;
    posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
}

/// Whether a table or function is a file's, not one that the program knows by a word.
bool is_file_name(const std::string& name) { return name.find_first_of("/.") != std::string::npos; }
/// Whether a volume is a file's, not a sample, nor what comes by standard input, nor none.
bool is_volume_file(const std::string& name) { return !name.empty() && name != "-" && !name.starts_with("sample:"); }

/// The folders that the viewer is started with: where one is, and where volume, scene and data are.
std::vector<std::filesystem::path> folders_of(const ViewOptions& o, const std::optional<Scene>& scene) {
    namespace fs = std::filesystem;
    std::vector<fs::path> folders{fs::current_path()};
    const auto add = [&](const fs::path& file) {
        std::error_code ignored;
        folders.push_back(fs::is_directory(file, ignored) ? file : fs::absolute(file).parent_path());
    };
    const auto add_volume = [&](const std::string& name) {
        if (is_volume_file(name)) add(split_volume_name(name).first);
    };
    if (scene) {
        add_volume(scene->volume);
        add_volume(scene->labels.source);
        if (is_file_name(scene->labels.table)) add(scene->labels.table);
        for (const ChannelSettings& channel : scene->channels) add_volume(channel.file);
    }
    if (!o.source.scene.empty()) add(o.source.scene);
    if (!o.source.data.empty()) add(o.source.data);
    return folders;
}

/// Names that hold wherever a page's scene stands.
Scene with_whole_names(Scene scene) {
    const auto whole = [](std::string& name) { name = std::filesystem::absolute(name).lexically_normal().string(); };
    const auto whole_volume = [&](std::string& name) {
        if (is_volume_file(name)) whole(name);
    };
    const auto whole_file = [&](std::string& name) {
        if (is_file_name(name)) whole(name);
    };
    whole_volume(scene.volume);
    whole_volume(scene.labels.source);
    whole_file(scene.labels.table);
    whole_file(scene.transfer.source);
    for (ChannelSettings& channel : scene.channels) whole_volume(channel.file), whole_file(channel.transfer.source);
    if (!is_probe_name(scene.lighting.probe.source)) whole(scene.lighting.probe.source);
    return scene;
}

void tell(const server::Viewer& viewer, const ViewOptions& o) {
    fmt::print("{}\n", viewer.url());
    std::fflush(stdout);
    if (o.common.quiet) return;
    const std::string whole = viewer.url();
    say(fmt::format(
        "from another computer: ssh -L {0}:localhost:{0} THIS_COMPUTER, then the address above; Ctrl-C ends",
        viewer.port()));
    if (o.host != "127.0.0.1" && o.host != "localhost" && o.host != "::1")
        say("warning: anybody on this network who knows the address can use this page, and what is sent is not "
            "encrypted");
}

void run(const ViewOptions& o) {
    server::ViewerOptions options;
    if (!o.source.volume.empty() || !o.source.scene.empty() || o.flags.any())
        options.scene = with_whole_names(scene_from(o.source, o.flags, o.common, "view"));
    if (o.port && (*o.port < 0 || *o.port > 65535))
        throw Error(ErrorCode::usage, fmt::format("--port {}: must be 0 (any that is free) to 65535", *o.port));
    options.folders = folders_of(o, options.scene);
    options.data = o.source.data;
    options.host = o.host, options.port = o.port;
    if (!(o.max_upload >= 0 && o.max_upload <= 1e6))
        throw Error(ErrorCode::usage, fmt::format("--max-upload {}: must be 0 to 1000000", o.max_upload));
    options.max_upload = std::uint64_t(o.max_upload * 1073741824.0);
    options.keep_views = true;
    options.base_path = o.base_path, options.embed_from = o.embed_from;
    options.device = device_of(o.common);
    options.paging = paging_of(o.paging);
    ProgressBar bar(o.common.progress, o.common.quiet);
    options.report = bar.report();
    options.read_in = [&](double seconds) {
        bar.clear();
        if (o.common.verbose) say(fmt::format("read {} in {:.3f} s", options.scene->volume, seconds));
    };
    options.unreadable = [&](const std::string& sentence) {
        bar.clear();
        say(sentence + "; the page goes on without it");
    };
    server::Viewer viewer(options);
    tell(viewer, o);
    if (!o.no_open && has_display()) open_browser(viewer.url());
    viewer.run(true);
    end_within_a_second();  // what views are still doing is cancelled; some of it notices late
}

}  // namespace

Command view_command(CLI::App& tool) {
    const auto o = std::make_shared<ViewOptions>();
    CLI::App* app = tool.add_subcommand("view", "Explores a volume in the browser");
    add_scene_source(*app, o->source);
    app->add_option("--port", o->port, "port to serve at; 0: any that is free (8480, or another where that is taken)")
        ->type_name("N");
    app->add_option("--host", o->host, "address to serve at (127.0.0.1: this computer alone)")->type_name("ADDR");
    app->add_option("--base-path", o->base_path, "path under which a proxy has the page [/]")->type_name("/PATH/");
    app->add_option("--embed-from", o->embed_from,
                    "origin that may frame the page, and that it may have behind a proxy (may be repeated)")
        ->type_name("ORIGIN")
        ->expected(1)
        ->take_all();
    app->add_option("--max-upload", o->max_upload, "largest volume that a page may send, in GiB; 0: none [4]")
        ->type_name("GIB");
    app->add_flag("--no-open", o->no_open, "only prints the address");
    add_paging_options(*app, o->paging);
    add_common_options(*app, o->common);
    o->flags.add_to(*app);
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
