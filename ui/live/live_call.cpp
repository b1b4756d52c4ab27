#include "ui/live/live_call.hpp"

#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "ui/rig/control_call.hpp"
#include "ui/rig/json_line.hpp"

namespace palpate::ui {

std::vector<RunningSession> running_sessions(const std::optional<std::string>& of) {
    const bool is_file = of && identity_of(*of) && !of->empty();
    std::vector<RunningSession> all;
    for (const std::string& name : session_names(is_file ? of : std::nullopt)) {
        const ControlAnswer answer = ask_session(name, R"({"do":"state"})");
        const data::Json said = object_in(answer.line);
        if (!said.contains("state") || !said["state"].is_object()) {
            continue;
        }
        std::string uuid = said["state"].value("session", "");
        if (of && !is_file && uuid != *of) {
            continue;
        }
        try {
            all.push_back({.name = name,
                           .file = said.value("file", ""),
                           .uuid = std::move(uuid),
                           .process = {said.value("pid", std::int64_t{0}),
                                       said.value("started", std::uint64_t{0})},
                           .reader = std::make_unique<LiveReader>(answer.file.get())});
        } catch (const std::runtime_error&) {  // of another version
        }
    }
    return all;
}

}  // namespace palpate::ui
