#pragma once

#include <nlohmann/json.hpp>

#include "data/csv/json_text.hpp"
#include "data/store/database.hpp"
#include "ui/live/live_segment.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/process.hpp"
#include "tests/support/test_text.hpp"

namespace palpate::tests {

/// How often: as the environment's `name` says, else `usual`.
[[nodiscard]] inline int times(const char* name, int usual) {
    const char* asked = std::getenv(name);
    return asked != nullptr ? std::stoi(asked) : usual;
}

/// `palpate run` without a window, slow enough to be looked at; the study is longer than any test.
/// kFourTrials is short.
class ShownSession {
public:
    /// @param speed  and what else is said to `run`
    explicit ShownSession(const std::string& protocol = "shape_friction",
                          const std::vector<std::string>& speed = {"2"})
        : file(folder_.file("d.sqlite")), program(command(protocol, speed)) {
        REQUIRE(eventually([&] {
            auto all = ui::running_sessions(file);
            if (!all.empty()) {
                shown = std::move(all.front());
            }
            return shown.reader != nullptr;
        }));
    }
    [[nodiscard]] data::Json ask(const data::Json& line) const {
        return data::Json::parse(ui::ask_session(shown.name, line.dump()).line, nullptr, false);
    }
    /// Empty before it shows any.
    [[nodiscard]] data::Json state() const {
        const auto state = shown.reader->state();
        return state ? data::Json::parse(state->json, nullptr, false) : data::Json::object();
    }
    [[nodiscard]] bool comes_to(const std::string& phase) const {
        return eventually([&] { return state().value("phase", "") == phase; });
    }
    [[nodiscard]] std::string kept(const std::string& sql) const {
        data::Database database(file, data::Access::read);
        data::Statement row = database.prepare(sql);
        return row.step() ? row.text(0) : "nothing";
    }
    [[nodiscard]] bool keeps(const std::string& sql, const std::string& value) const {
        return eventually([&] { return kept(sql) == value; });
    }

private:
    [[nodiscard]] std::vector<std::string> command(const std::string& protocol,
                                                   const std::vector<std::string>& more) const {
        std::vector<std::string> words{
            palpate_program(), "run",        protocol, "--participant", "P1",       "--db",   file,
            "--headless",      "--operator", "Ada",    "--secret",      kRunSecret, "--speed"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    TemporaryFolder folder_;

public:
    std::string file;
    Process program;
    ui::RunningSession shown;
};

}  // namespace palpate::tests
