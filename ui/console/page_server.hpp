#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/clock.hpp"
#include "engine/base/descriptor.hpp"

struct MHD_Daemon;

/// A page for the experimenter's browser, served to whoever was given its address.
///
/// The address has a token of 128 bits, which is traded for a cookie of another 128 that no script
/// reads and no other site sends. Host and Origin must be this server's own: neither another page
/// in the same browser nor a name that was made to point here gets an answer. Nothing is loaded
/// from anywhere else, and nothing is kept by the browser. Connections, their memory and their
/// silence have limits; of many without the cookie who came first makes room.
namespace palpate::ui {

/// What one open page gets, on a thread of its own: what is new since the last call as server-sent
/// events, "event: ...\ndata: ...\n\n"; empty: nothing. None: nothing will ever be, and the page is
/// let go.
using EventSource = std::function<std::optional<std::string>()>;

struct PageServerSpec {
    static constexpr const char* kHere = "127.0.0.1";
    std::string address = kHere;  ///< another one takes a certificate and its key
    Descriptor listening{};       ///< a socket that listens there already
    std::string token{};          ///< of the address; empty: one of its own
    std::string cookie{};         ///< the token is traded for it; empty: one of its own
    std::string certificate{};    ///< PEM; empty: http
    std::string key{};            ///< PEM
    /// What is at "/", "/console.js", ...; empty: nothing is. On any thread. Its type is that of
    /// the path's end, and HTML without one.
    std::function<std::string(std::string_view path)> file{};
    /// @param shown  the page asks for what is felt as well
    /// @param still  it is hidden behind another one: for no more than where the session is
    std::function<EventSource(bool shown, bool still)> open{};
    /// A JSON object -> a JSON object, on any thread. None: the page may only look.
    /// @param gone  whoever asked has given up: what is done late is not what they meant
    std::function<std::string(const std::string&, bool gone)> act{};
};

class PageServer {
public:
    /// Events are looked for so often.
    static constexpr std::int64_t kPace = 33 * kMillisecond;
    static constexpr std::size_t kLongestBody = 8192;

    /// @throws std::invalid_argument for what is no single IPv4 address of this machine, and for an
    ///         address other than kHere in the clear
    /// @throws std::runtime_error if it cannot listen there
    explicit PageServer(PageServerSpec spec);
    ~PageServer();

    /// With its token.
    [[nodiscard]] std::string address() const;

private:
    friend struct PageRequest;
    class Strangers;

    PageServerSpec spec_;
    std::string host_;  ///< "127.0.0.1:34567"
    std::string port_;
    std::atomic<bool> ends_{false};
    std::unique_ptr<Strangers> strangers_;
    MHD_Daemon* daemon_ = nullptr;
};

}  // namespace palpate::ui
