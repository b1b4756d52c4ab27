#include <mutex>

#include "ui/console/page_server.hpp"
#include "ui/rig/json_line.hpp"
#include "tests/support/dev_tools.hpp"

// The experimenter's page as it lies in its files: what it is made of, and told of every state that
// a session can be in.

using data::Json;

namespace {

/// A session in which something is felt; what differs from it in other states, what the page then
/// says at the elements of some ids, and which buttons it bars.
const Json kTold = Json::parse(test_text("console_states.json"));

const Words kAll{"stop", "pause", "mark", "end", "note-send"};

/// Whatever somebody could not read: what is wider than its place, what the page is too narrow for,
/// buttons that cover each other, and a contrast below 4.5.
const std::string kUnreadable = test_text("scripts/unreadable.js");

std::string page_file(const std::string& name) {
    return slurp(PALPATE_SOURCE_DIR "/ui/console/page/console." + name);
}

/// What stands between `open` and `close`, everywhere in a text.
std::set<std::string> all_after(const std::string& text,
                                const std::string& open,
                                const std::string& close) {
    const Words all = between(text, open, close);
    return {all.begin(), all.end()};
}

/// The newest of what is told, once for each page.
struct Told {
    std::mutex mutex;
    std::string event;
};

}  // namespace

TEST_CASE("in every state the page says what is, bars what cannot be asked, and can be read",
          "[console]") {
    if (!DevTools::installed()) {
        return;
    }
    Told told;
    ui::PageServerSpec spec;
    spec.file = [](std::string_view path) {
        return page_file(path == "/" ? "html" : path == "/console.js" ? "js" : "css");
    };
    spec.open = [&told](bool /*shown*/, bool /*still*/) {
        return [&told, said = std::string()]() mutable -> std::optional<std::string> {
            const std::scoped_lock lock(told.mutex);
            return std::exchange(said, told.event) == told.event ? "event: live\ndata: {}\n\n"
                                                                 : told.event;
        };
    };
    const ui::PageServer server(std::move(spec));
    DevTools page(server.address());
    for (std::size_t i = 0; i < kTold["states"].size(); ++i) {
        const Json& state = kTold["states"][i];
        CAPTURE(state["differs"].dump());
        Json now = kTold["exploring"];
        now.merge_patch(state["differs"]);
        now["number"] = i;
        {
            const std::scoped_lock lock(told.mutex);
            told.event = ui::event_text("state", now);
        }
        page.run("(window.before = 1, location.reload())");
        REQUIRE(eventually([&] {
            return page.value("window.before") == "undefined" &&
                   page.text("number") == fmt::format("session {}", i);
        }));
        for (const auto& says : state["says"].get<std::vector<Words>>()) {
            const std::string shown = page.text(says[0]);
            CAPTURE(says, shown);
            CHECK_THAT(shown, Has(says[1]));
            CHECK((!says[1].empty() || shown.empty()));
        }
        for (const std::string& id : kAll) {
            CAPTURE(id);
            CHECK((page.value("document.getElementById('" + id + "').ariaDisabled") == "true") ==
                  (std::ranges::count(state["barred"], Json(id)) > 0));
        }
        for (const int width : {390, 844, 1120, 3840}) {
            for (const bool dark : {false, true}) {
                page.looks(width, dark);
                CAPTURE(width, dark);
                CHECK(page.value(kUnreadable) == "");
            }
        }
    }
}

TEST_CASE("the experimenter's page is of its own origin alone, and its script finds what it fills",
          "[console]") {
    const std::string html = page_file("html");
    const std::string script = page_file("js");
    const std::string style = page_file("css");
    for (const std::string& text : {html, script, style}) {
        REQUIRE_FALSE(text.empty());
        CHECK_THAT(text, HasNone("http:", "https:", "//www", "@import", "url(", "data:"));
    }
    CHECK_THAT(html, HasNone("<script>", "<style", " style=", " onclick", " onload"));
    for (const char* of_text : {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write",
                                "eval("}) {  // names and notes are text, never markup
        CAPTURE(of_text);
        CHECK_THAT(script, !Has(of_text));
    }
    const std::set<std::string> ids = all_after(html, " id=\"", "\"");
    const std::set<std::string> used = all_after(script, "$('", "'");
    CHECK(used.size() > 40);
    for (const std::string& id : used) {
        CAPTURE(id);
        CHECK(ids.contains(id));
    }
    for (const char* of : {" for=\"", " aria-labelledby=\""}) {
        for (const std::string& id : all_after(html, of, "\"")) {
            CAPTURE(id);
            CHECK(ids.contains(id));
        }
    }
    // Only what is in the contract is asked for.
    CHECK(all_after(script, "{ do: '", "'") ==
          std::set<std::string>{"end", "mark", "note", "reveal", "stop"});
}
