#include <mutex>

#include "ui/console/page_server.hpp"
#include "ui/rig/json_line.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/dev_tools.hpp"

// The experimenter's page as it lies in its files, told of every state that a session can be in.

using data::Json;

namespace {

const Json kExploring = Json::parse(R"({
    "session": "b1946ac9-2492-4d23-91f7-7d7a3c1b3a11", "kind": "real", "participant": "P17",
    "number": 2, "protocol": "shape_friction", "title": "Shape and friction at a vertex",
    "phase": "explore", "phase_s": 4.1, "sentence": "exploring, trial 27 of 104", "trial": 27,
    "trials": 104, "practice": false, "remaining": 78, "remaining_min": 31.5, "next_break_in": 5,
    "answered": 26, "not_counting": [], "faults": [], "alarm": false, "pausing": false,
    "solved": false, "force": {"on": true, "why": "exploring"}, "act": true, "alive": true,
    "late": {"edges_us": [5, 10, 100], "trial": [9, 1, 0, 0], "session": [3456789, 99, 5, 0],
             "stale_share": 0.0003},
    "device": {"name": "board:udp:192.168.100.200:45678", "calibration": "left rig",
               "round_trip_us": 412.3, "check": "passed", "watchdog": null, "dead_man": true},
    "disk_free_mb": 183234, "saved_ms": 40, "seal": "0123456789abcdef", "reveal": "ask",
    "masking": {"on": true, "level_db": -20}, "notes": [], "ended": null})");

/// What differs while something is felt, and what the page then says at the element of an id.
struct State {
    const char* differs;
    std::vector<std::pair<const char*, const char*>> says;
    Words barred;  ///< buttons
};

const Words kAll{"stop", "pause", "mark", "end", "note-send"};

const std::vector<State> kStates{
    {R"({})", {{"sentence", "exploring, trial 27"}, {"force-word", "Force on"}}, {}},
    {R"({"pausing": true})", {{"seconds", ", then a pause"}, {"pause-word", "Go on"}}, {}},
    {R"({"phase": "break", "sentence": "a break before trial 28 of 104", "phase_s": 754.2,
         "force": {"on": false, "why": "nothing is felt now"}})",
     {{"seconds", ", 12 min 34 s"}, {"force-why", "(nothing is felt now)"}},
     {}},
    {R"({"phase": "pause", "sentence": "paused by the experimenter before trial 28 of 104",
         "force": {"on": false, "why": "nothing is felt now"}})",
     {{"pause-word", "Go on"}, {"force-word", "Force off"}},
     {}},
    {R"({"phase": "trouble", "sentence": "the handle jumped: check the encoder cables",
         "force": {"on": false, "why": "the handle jumped: check the encoder cables"},
         "faults": [{"trial": 3, "practice": true, "cause": "over_speed", "advice": "slowly"}]})",
     {{"alerts", "no force until it is mended.the handle jumped: check the encoder cables"},
      {"sentence", "trouble in trial 27 of 104"},
      {"force-why", ""},
      {"faults", "Practice 3: over speed"}},
     {"pause"}},
    {R"({"phase": "trouble", "sentence": "somebody stopped the force", "solved": true,
         "force": {"on": false, "why": "stopped"}})",
     {{"alerts", "The trouble is over: at the participant"}},
     {"pause"}},
    {R"({"phase": "trouble", "sentence": "nothing proves that the motors are off",
         "force": {"on": null, "why": "nothing proves that the motors are off"}})",
     {{"alerts", "the motors may still give force"}, {"force-word", "Force not known"}},
     {"pause"}},
    {R"({"phase": "ended", "ended": "given up", "sentence": "the session is over: given up",
         "force": {"on": null, "why": "nothing proves that the motors are off"}})",
     {{"force-word", "Force not known"}, {"force-why", "(nothing proves"}},
     kAll},
    {R"({"alarm": true, "not_counting": [{"trial": 9, "practice": false, "why": "timed_out"},
         {"trial": 11, "practice": false, "why": "marked: my_own words"}]})",
     {{"alerts", "Three of the last six"}, {"not", "words"}, {"not", "Trial 9: timed out"}},
     {}},
    {R"({"act": false})", {{"hint", "may only look"}}, kAll},
    {R"({"phase": "ended", "ended": "finished", "sentence": "the session is over: finished"})",
     {{"alerts", "is finished"}, {"force-word", "Force off"}, {"hint", "that is over"}},
     kAll},
    {R"({"alive": false, "ended": "killed"})",
     {{"alerts", "The session is gone."}, {"force-word", "not known"}, {"sentence", "last heard"}},
     kAll},
    {R"({"reveal": "shown", "hidden": {"object": "convex", "friction": "high", "level": 12.5,
         "outline": [[0.03, 0], [0, 0.02], [-0.03, 0]], "answers": [{"trial": 1, "correct": false,
         "practice": false, "object": "convex", "friction": "high", "answer": "concave"}]}})",
     {{"hidden", "convex"}, {"answers", "wrong"}, {"scene-text", "No hand was seen yet."}},
     {}}};

/// Whatever somebody could not read: what is wider than its place, what the page is too narrow for,
/// buttons that cover each other, and a contrast below 4.5.
constexpr const char* kUnreadable = R"((() => {
  const shown = [...document.querySelectorAll('body *')].filter(e => e.checkVisibility());
  const rgb = text => text.match(/[\d.]+/g).map(Number);
  const light = c => c.slice(0, 3).map(v => v / 255)
    .map(v => v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = e => {
    const c = rgb(getComputedStyle(e).backgroundColor);
    return c.length < 4 || c[3] > 0 ? c : e === document.documentElement ? [255, 255, 255]
      : behind(e.parentElement);
  };
  const bad = [];
  for (const e of shown) {
    const style = getComputedStyle(e), name = e.tagName + ' ' + e.id + ' ' + e.textContent.slice(0, 30);
    if (style.overflowX !== 'visible' && !e.matches('.unseen, input, section') &&
        e.scrollWidth > e.clientWidth + 1) bad.push('cut off: ' + name);
    const box = e.getBoundingClientRect();
    if (!e.closest('.scroll, .unseen') && box.right > innerWidth + 1) bad.push('too wide: ' + name);
    if (![...e.childNodes].some(n => n.nodeType === 3 && n.data.trim() !== '')) continue;
    const both = [light(rgb(style.color)), light(behind(e))].sort((a, b) => a - b);
    const contrast = (both[1] + 0.05) / (both[0] + 0.05);
    if (contrast < 4.5) bad.push('contrast ' + contrast.toFixed(2) + ': ' + name);
  }
  const boxes = shown.filter(e => e.matches('button') && getComputedStyle(e).position !== 'fixed')
    .map(e => e.getBoundingClientRect());
  boxes.forEach((a, i) => boxes.slice(0, i).forEach(b => {
    if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1) {
      bad.push('buttons that cover each other');
    }
  }));
  return bad.join('\n');
})())";

std::string page_file(const std::string& name) {
    return slurp(PALPATE_SOURCE_DIR "/ui/console/page/console." + name);
}

/// The newest of what is told, once for each page.
struct Told {
    std::mutex mutex;
    std::string event;
};

}  // namespace

TEST_CASE("in every state the page says what is, bars what cannot be asked, and can be read",
          "[console][law]") {
    if (!DevTools::installed()) {
        return;
    }
    Told told;
    ui::PageServerSpec spec;
    spec.file = [](std::string_view path) {
        return std::optional(page_file(path == "/"             ? "html"
                                       : path == "/console.js" ? "js"
                                                               : "css"));
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
    for (std::size_t i = 0; i < kStates.size(); ++i) {
        const State& state = kStates[i];
        CAPTURE(state.differs);
        Json now = kExploring;
        now.merge_patch(Json::parse(state.differs));
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
        for (const auto& [id, words] : state.says) {
            CAPTURE(id, page.text(id));
            CHECK_THAT(page.text(id), Has(words));
            CHECK((*words != '\0' || page.text(id).empty()));
        }
        for (const std::string& id : kAll) {
            CAPTURE(id);
            CHECK((page.value("document.getElementById('" + id + "').ariaDisabled") == "true") ==
                  (std::ranges::count(state.barred, id) > 0));
        }
        for (const int width : {390, 1120, 3840}) {
            for (const bool dark : {false, true}) {
                page.looks(width, dark);
                CAPTURE(width, dark);
                CHECK(page.value(kUnreadable) == "");
            }
        }
    }
}
