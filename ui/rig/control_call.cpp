#include "ui/rig/control_call.hpp"

#include <algorithm>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>

#include "engine/base/clock.hpp"
#include "ui/rig/json_line.hpp"

namespace palpate::ui {
namespace {

constexpr int kAnswerMs = 2000;  ///< a session's time to answer

/// Until `end`, on the clock of monotonic_ns(). Hung up: no line, and `ended`.
ControlAnswer line_from(const Descriptor& from, std::int64_t end, bool& ended) {
    ControlAnswer answer;
    while (!ended && !answer.line.ends_with('\n')) {
        const std::int64_t left = (end - monotonic_ns()) / kMillisecond;
        if (!readable(from.get(), static_cast<int>(std::max<std::int64_t>(left, 0)))) {
            return {};
        }
        Received received = receive(from.get());
        ended = received.ended;
        answer.line += received.bytes;
        if (received.file.get() >= 0) {
            answer.file = std::move(received.file);
        }
    }
    return answer;
}

}  // namespace

StopResult stop_sessions(const std::optional<std::string>& database) {
    const Descriptor right(database ? open(database->c_str(), O_RDWR | O_CLOEXEC) : -1);
    std::vector<Descriptor> lines;
    for (const std::string& name : session_names(database)) {
        if (Descriptor line = connect_to(name); line.get() >= 0) {
            send_line(line.get(), database ? R"({"do":"stop"})" : R"({"do":"stop","people":true})",
                      right.get());
            lines.push_back(std::move(line));
        }
    }
    StopResult stopped;
    const std::int64_t end = monotonic_ns() + kAnswerMs * kMillisecond;
    for (const Descriptor& line : lines) {
        bool ended = false;
        const std::string text = line_from(line, end, ended).line;
        const data::Json answer = object_in(text);
        const bool ok = answer.value("ok", false);
        (ok ? stopped.sessions : ended || !text.empty() ? stopped.refused : stopped.silent) += 1;
        stopped.labels += ok ? answer.value("text", "") : "";
    }
    return stopped;
}

ControlAnswer ask_session(const std::string& name, const std::string& line) {
    const Descriptor to = connect_to(name);
    bool ended = to.get() < 0 || !send_line(to.get(), line);
    return line_from(to, monotonic_ns() + kAnswerMs * kMillisecond, ended);
}

}  // namespace palpate::ui
