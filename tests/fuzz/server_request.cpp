// The head of a request as Beast hands it over, and a message: the first byte chooses.
#include "fuzz.h"

#include <boost/beast/http.hpp>

#include "server/json.h"
#include "server/net_guard.h"

namespace {

void head(const std::string& text) {
    namespace http = boost::beast::http;
    http::request_parser<http::string_body> parser;
    parser.header_limit(16384);
    boost::system::error_code error;
    parser.put(boost::asio::buffer(text), error);
    if (!parser.is_header_done()) return;
    const auto& request = parser.get();
    static const chiaro::server::Doorman doorman({.host = "127.0.0.1", .embed_from = {"https://hub.example:8443"}});
    (void)doorman.lets_in(std::string(request[http::field::host]), std::string(request[http::field::origin]));
    (void)chiaro::server::request_of(std::string(request.method_string()), std::string(request.target()));
}

void message(const std::string& text) {
    using namespace chiaro::server;
    const Json request = parse_message(text);
    (void)text_in(request, "type");
    (void)size_in(request, "size", 16384);
    (void)number_in(request, "x", -1e5, 1e5);
    (void)flag_in(request, "moving", false);
    (void)object_in(request, "scene");
    (void)text_of(request);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string text = fuzz::text(data + 1, size - 1);
    if (chiaro::server::text_of(chiaro::server::error_message(nullptr, "usage", text)).size() > 20000) std::abort();
    return fuzz::refusing([&] { *data % 2 ? head(text) : message(text); }, true);
}
