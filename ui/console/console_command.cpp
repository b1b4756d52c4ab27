#include <algorithm>
#include <array>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sched.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "ui/command/command.hpp"
#include "ui/console/session_stream.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

// As they lie in page/.
std::string_view console_page(), console_style(), console_script();

namespace {

constexpr std::int64_t kLinger = 10'000 * kMillisecond;

struct ConsoleOptions {
    std::optional<std::string> of;
    std::string listen;
    std::vector<std::string> tls;
    bool act = false;
    bool while_runs = false;
};

void declare(CommandWords& words, ConsoleOptions& options) {
    words.add("SESSION", options.of,
              "Its database, or its uuid; without it the only one that runs on this machine");
    words
        .add("--listen", options.listen,
             "An address of this machine for other machines to look at, such as 192.168.1.5; they "
             "may only look")
        .needs("--tls");
    words.add("--tls", options.tls, "Certificate and key of that address, two PEM files")
        .needs("--listen");
    words.add("--act", options.act, "Other machines may act as well").needs("--listen");
    words.add("--while-runs", options.while_runs, "Ends 10 s after the session does");
}

RunningSession the_session(const std::optional<std::string>& of) {
    std::vector<RunningSession> all = running_sessions(of);
    refuse_if(all.empty(), "{}",
              of ? fmt::format("{}: no session of yours that answers runs on it, and none has that "
                               "uuid; palpate status says whether one hangs",
                               *of)
                 : std::string("no session of yours that answers runs: begin one with palpate "
                               "run"));
    if (all.size() > 1) {
        std::string text = "several sessions run; name one of these:";
        for (const RunningSession& one : all) {
            text += fmt::format("\n    palpate console {}  ({})", one.uuid, one.file);
        }
        throw std::invalid_argument(text);
    }
    return std::move(all.front());
}

std::optional<std::string> console_file(std::string_view path) {
    constexpr std::array<std::pair<std::string_view, std::string_view (*)()>, 3> kParts{{
        {"/", console_page},
        {"/console.css", console_style},
        {"/console.js", console_script},
    }};
    const auto* found = std::ranges::find(kParts, path, &decltype(kParts)::value_type::first);
    return found == kParts.end() ? std::nullopt : std::optional(std::string(found->second()));
}

/// That of every page of the session, which holds it: one that was open goes on with this server.
void take_address(const std::string& session, PageServerSpec& spec) {
    const Received held = ask_session(session, R"({"do":"page"})");
    const data::Json said = object_in(held.line);
    if (said.value("ok", false)) {
        spec.listening = fcntl(held.file.get(), F_DUPFD_CLOEXEC, 0);  // the server closes it
        spec.token = said.value("token", "");
        spec.cookie = said.value("cookie", "");
    }
}

/// @param holds  what a PEM file of its kind has
std::string pem_text(const std::string& file, std::string_view holds) {
    std::error_code none;
    std::string text = std::filesystem::is_regular_file(file, none) ? file_text(file) : "";
    refuse_if(text.find(holds) == std::string::npos,
              "{}: {}; --tls takes a certificate and its key, two PEM files: openssl req -x509 "
              "-nodes -newkey rsa:2048 -addext subjectAltName=IP:ADDRESS -subj /CN=palpate -keyout "
              "KEY -out CERT makes them",
              file,
              text.empty() ? "no file that can be read is there"
                           : fmt::format("has no line \"-----BEGIN ... {}\"", holds));
    return text;
}

int run(const ConsoleOptions& options) {
    catch_signals();
    const sched_param usual{};
    sched_setscheduler(0, SCHED_BATCH, &usual);  // whoever wakes goes first: the session
    refuse_if(!options.tls.empty() && options.tls.size() != 2,
              "--tls takes two files: --tls CERT KEY");
    PageServerSpec spec;
    const bool acts = options.listen.empty() || options.act;
    if (!options.listen.empty()) {
        spec.address = options.listen;
        spec.certificate = pem_text(options.tls[0], "CERTIFICATE-----");
        spec.key = pem_text(options.tls[1], "PRIVATE KEY-----");
    }
    auto watched = std::make_shared<WatchedSession>(the_session(options.of), acts);
    if (options.listen.empty()) {
        take_address(watched->session().name, spec);
    }
    spec.file = console_file;
    spec.open = [watched](bool shown, bool still) {
        return std::make_unique<SessionStream>(watched, shown, still);
    };
    if (acts) {
        spec.act = [watched](const std::string& line, bool gone) {
            return watched->ask(line, gone);
        };
    }
    const PageServer server(std::move(spec));
    say("The experimenter's page, for your eyes alone: {}\nCtrl+C {}.\n", server.address(),
        options.while_runs
            ? "at the session's terminal ends the session, and 10 s after it the page"
            : "ends it; the session goes on");
    std::int64_t seen_ns = monotonic_ns();
    bool alive = true;
    while (!interrupted() && (!options.while_runs || monotonic_ns() - seen_ns < kLinger)) {
        alive = alive && watched->alive();
        seen_ns = alive ? monotonic_ns() : seen_ns;
        sleep_until(monotonic_ns() + 200 * kMillisecond);
    }
    return 0;
}

}  // namespace

Command console_command() {
    return make_command<ConsoleOptions>(
        "console", "Serve a page on a running session to your browser", declare, run);
}

}  // namespace palpate::ui
