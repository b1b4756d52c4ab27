#include "protocols/file/keys.hpp"
#include "ui/subject/paragraph.hpp"
#include "ui/subject/stroke.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/scenes.hpp"
#include "tests/ui/keys.hpp"

using namespace palpate::protocols;
using namespace palpate::ui;

using engine::Vec2;

namespace {

const std::vector<Vec2> kSizes{{800.0, 600.0}, {800.0, 480.0},   {1280.0, 720.0},
                               {600.0, 800.0}, {1080.0, 1920.0}, {2560.0, 1080.0}};

/// As much as a protocol may say, in words and in rows.
std::string longest(const std::string& words) {
    std::string text;
    while (text.size() + words.size() <= kMaxInstruction) {
        text += words;
    }
    return text;
}

struct Shown {
    std::string name;
    std::function<void(Window&)> draw;
    std::string_view ui::Words::*to_press =
        nullptr;                ///< must be there; none: the face asks for nothing
    std::vector<Card> cards{};  ///< that stand on it
};

template <class Face>
Shown shown(Face face, std::string_view ui::Words::*to_press = nullptr) {
    return {std::string(Face::kName), [face](Window& window) { draw(window, face); }, to_press};
}

std::vector<Picture> five_pictures() {
    std::vector<Picture> all;
    for (const double curvature : {-10.0, -5.0, 0.0, 5.0, 10.0}) {
        all.push_back({stimuli::silhouette({.curvature = curvature})});
    }
    return all;
}

/// Every face with whatever makes its text longer.
std::vector<Shown> all_faces(const std::vector<Picture>& pictures, const Vec2& size) {
    std::vector<Shown> all;
    for (const ResponseKind asks :
         {ResponseKind::identification, ResponseKind::two_interval, ResponseKind::yes_no}) {
        all.push_back(shown(WelcomeFace{1114, 112, true, true, true, asks}, &ui::Words::begin));
        all.push_back(shown(WelcomeFace{1, 0, false, false, false, asks}, &ui::Words::begin));
    }
    TrialView trial{.number = 1027, .total = 1114, .practice = true, .intervals = 2};
    all.push_back(shown(ReadyFace{trial, true}, &ui::Words::hold_to_feel));
    trial.interval = 2;
    all.push_back(shown(ReadyFace{trial, false}, &ui::Words::press_to_feel));
    for (const auto& [x, open, inside, to_press] :
         {std::tuple(0.03, true, false, &ui::Words::press_to_feel),
          std::tuple(0.03, false, false, &ui::Words::bring_to_start),
          std::tuple(0.004, false, false, &ui::Words::bring_to_height),
          std::tuple(0.0, false, true, &ui::Words::bring_out)}) {
        const StartMark mark{{x, 0.0, 0.01}, 0.005, true, open, inside, true};
        all.push_back(shown(ReadyFace{trial, false, mark}, to_press));
    }
    for (const bool shape : {false, true}) {
        all.push_back(shown(ExploreFace{trial, true, true, true, shape},
                            shape ? &ui::Words::enter_when_known : &ui::Words::enter_when_felt));
        all.push_back(shown(ExploreFace{trial, false, true, false, shape},
                            shape ? &ui::Words::space_when_known : &ui::Words::space_when_felt));
    }
    const auto ask = [&](Question question) {
        const bool slow = question.kind == ResponseKind::identification && size.x * size.y > 2e6;
        for (const bool worded : {false, true}) {
            if (slow && !worded) {  // the pictures are drawn once
                continue;
            }
            question.text = worded ? longest("Hangisi daha pürüzlüydü? ") : "";
            Shown face = shown(ChooseFace{question, question.answers - 1, false},
                               question.answers == 2 ? &ui::Words::choose_of_two : nullptr);
            face.cards = lay_out_answers(question, size);
            all.push_back(face);
        }
    };
    ask(which_of(pictures));
    ask(which_of(std::span(pictures).first(2)));
    for (const ResponseKind kind : {ResponseKind::two_interval, ResponseKind::yes_no}) {
        ask({.kind = kind, .text = {}, .pictures = {}, .answers = 2, .labels = {}});
    }
    for (const std::size_t levels : {2U, 9U}) {
        ask({.kind = ResponseKind::rating,
             .text = {},
             .pictures = {},
             .answers = levels,
             .labels = {"not rough at all, like glass", "as rough as it can be"}});
    }
    all.push_back(shown(ConfidenceFace{2, true}));
    all.back().cards = lay_out_scale(kMaxConfidence, size);
    all.push_back(shown(FeedbackFace{true}));
    all.push_back(shown(FeedbackFace{false}));
    const TrialView next{.number = 1031, .total = 1114};
    all.push_back(shown(BreakFace{0, next}, &ui::Words::go_on));
    all.push_back(shown(BreakFace{120, {.number = 1031, .total = 1114, .practice = true}}));
    all.push_back(shown(BreakFace{0, next, true}, &ui::Words::home_first));
    const std::string sentence =
        "/dev/serial/by-id/usb-Haply_Robotics_2diy_0123456789-if00: the device stopped answering "
        "17 s ago: check its cable and its power, then wait until it is found again";
    all.push_back(shown(TroubleFace{sentence, false, false}));
    all.push_back(shown(TroubleFace{sentence, true, false}, &ui::Words::go_on));
    all.push_back(shown(TroubleFace{sentence, true, true}, &ui::Words::end_of_pause));
    all.push_back(shown(PauseFace{}, &ui::Words::end_of_pause));
    all.push_back(shown(EndFace{}, &ui::Words::tell_experimenter));
    return all;
}

bool apart(const Vec2& corner, const Vec2& size, const TextExtent& line) {
    return line.corner.x >= corner.x + size.x || line.corner.y >= corner.y + size.y ||
           line.corner.x + line.size.x <= corner.x || line.corner.y + line.size.y <= corner.y;
}

bool within(const Vec2& corner, const Vec2& size, const TextExtent& line) {
    const Vec2 end = line.corner + line.size;
    return line.corner.x >= corner.x && line.corner.y >= corner.y && end.x <= corner.x + size.x &&
           end.y <= corner.y + size.y;
}

/// @param lowest  share of the height that text must not go below
void check_layout(const Window& window, const Shown& face, double lowest = kBarTop) {
    const std::vector<TextExtent>& lines = window.written();
    const Vec2 place{window.size().x, lowest * window.size().y};
    std::string words;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        CAPTURE(lines[i].text);
        words += lines[i].text;
        words += ' ';
        CHECK(within({0.0, 0.0}, place, lines[i]));
        CHECK(lines[i].size.y >= kSmallestType);
        for (std::size_t k = 0; k < i; ++k) {
            CAPTURE(lines[k].text);
            CHECK(apart(lines[k].corner, lines[k].size, lines[i]));
        }
        for (const Card& card : face.cards) {
            CHECK((within(card.corner, card.size, lines[i]) ||
                   apart(card.corner, card.size, lines[i])));
        }
    }
    if (face.to_press != nullptr) {
        CHECK_THAT(words, Catch::Contains(std::string(window.words().*face.to_press)));
    }
}

/// Small letters of DejaVu Sans are 0.547 of the type high, a line 1.164 (its font file). Minutes
/// of arc from 1 m, on a screen 0.30 m high.
double minutes_of_arc(const Window& window, const TextExtent& line) {
    const double metres = 0.30 * (line.size.y / 1.164) * 0.547 / window.size().y;
    return metres / 1.0 * 180.0 / M_PI * 60.0;
}

/// Pixels covered when `corners` are drawn in white on black.
double coverage(const std::vector<Corner>& corners) {
    draw_into_memory();
    Window window({.width = 640, .height = 480, .font = {}});
    window.clear({0, 0, 0});
    window.fine({0.0, 0.0}, {640.0, 480.0}, [&] { window.triangles(corners, {255, 255, 255}); });
    window.present();
    double sum = 0.0;
    const std::vector<std::uint8_t> pixels = window.pixels();
    for (std::size_t i = 0; i < pixels.size(); i += 4) {
        sum += pixels[i] / 255.0;
    }
    return sum;
}

std::vector<Vec2> ellipse(double a, double b, int points) {
    std::vector<Vec2> outline;
    for (int i = 0; i < points; ++i) {
        const double t = 2.0 * M_PI * i / points;
        outline.push_back({320.3 + a * std::cos(t), 240.6 + b * std::sin(t)});
    }
    return outline;
}

}  // namespace

TEST_CASE("nothing on any face is cut off, overlaps or is missing, on screens of every size") {
    draw_into_memory();
    const Vec2 size = GENERATE(from_range(kSizes));
    const Language language = GENERATE(Language::en, Language::tr);
    if (size.x * size.y > 2e6 && language == Language::tr) {
        return;  // what is longer is cut off where there is less room
    }
    std::vector<std::string> texts{""};
    if (size.x * size.y < 1e6 && language == Language::tr) {  // where there is least room
        texts.push_back(longest("nesneleri hissedin "));
        texts.push_back(std::string("1\n2\n3\n4\n5\n6\n7\n8"));
    }
    const std::vector<Picture> pictures = five_pictures();
    for (const std::string& said : texts) {
        Window window({.width = static_cast<int>(size.x),
                       .height = static_cast<int>(size.y),
                       .font = {},
                       .language = language,
                       .instructions = {said, said, said, said, said, said}});
        REQUIRE(window.size() == size);
        for (const Shown& face : all_faces(pictures, size)) {
            CAPTURE(size.x, size.y, face.name, said.size());
            window.clear(kBackground);
            draw_watermark(window, "SIMULATED");
            face.draw(window);
            check_layout(window, face);
        }
    }
}

TEST_CASE("what the experimenter reads is 16 minutes of arc high from 1 m, and inside the window") {
    draw_into_memory();
    const Vec2 size = GENERATE(from_range(kSizes));
    const Language language = GENERATE(Language::en, Language::tr);
    Window window({.width = static_cast<int>(size.x),
                   .height = static_cast<int>(size.y),
                   .font = {},
                   .language = language});
    const ui::Words& words = window.words();
    for (const auto sentence : {words.stop_question, words.mark_question, words.mark_last_question,
                                words.pause_comes, words.no_pause, words.session_over, words.marked,
                                words.practice_marked, words.nothing_to_mark}) {
        window.clear(kBackground);
        draw_bar(window, sentence);
        check_layout(window, {}, 1.0);
        CHECK(window.written().front().corner.y >= kBarTop * size.y);
        for (const TextExtent& line : window.written()) {
            CAPTURE(size.x, size.y, line.text);
            CHECK((size.x < size.y || minutes_of_arc(window, line) >= 16.0));
        }
    }
    window.clear(kBackground);
    draw(window,
         TroubleFace{"the device stopped answering: check its cable and power", true, true});
    for (const TextExtent& line : window.written()) {
        CAPTURE(size.x, size.y, line.text);
        CHECK((size.x < size.y || minutes_of_arc(window, line) >= 16.0));
    }
}

TEST_CASE("on a Turkish screen a trouble is said in Turkish alone") {
    draw_into_memory();
    Window window({.width = 1280, .height = 800, .font = {}, .language = Language::tr});
    for (int i = 1; i <= static_cast<int>(engine::Trip::stopped); ++i) {
        const std::string_view english = explanation(static_cast<engine::Trip>(i));
        window.clear(kBackground);
        draw(window, TroubleFace{std::string(english), true, true});
        std::string said;
        for (const TextExtent& line : window.written()) {
            said += line.text + ' ';
        }
        CHECK_THAT(said, Catch::Contains(std::string(trip_in(Language::tr, english))) &&
                             !Catch::Contains(std::string(english)));
    }
}

// Closed form: a line of width w along a circle of radius R covers 2 pi R w.
TEST_CASE("a stroke covers its true area within 1 %") {
    for (const double radius : {60.0, 180.0}) {
        for (const double width : {4.0, 15.0}) {
            CAPTURE(radius, width);
            const double area = 2.0 * M_PI * radius * width;
            CHECK(std::fabs(coverage(stroke(ellipse(radius, radius, 90), width)) / area - 1.0) <
                  0.01);
        }
    }
}

TEST_CASE("a straight bar covers its true area at every angle") {
    for (int degrees = 0; degrees < 180; degrees += 35) {
        CAPTURE(degrees);
        const double t = degrees * M_PI / 180.0;
        const Vec2 along{std::cos(t), std::sin(t)};
        const Vec2 across{-along.y, along.x};
        const Vec2 middle{320.2, 240.7};
        // A closed stroke round a long rectangle: its two long sides and mitred corners.
        const std::vector<Vec2> box{
            middle - 150.0 * along - 40.0 * across, middle + 150.0 * along - 40.0 * across,
            middle + 150.0 * along + 40.0 * across, middle - 150.0 * along + 40.0 * across};
        const double width = 8.0;
        const double area = 2.0 * width * (300.0 + 80.0);
        CHECK(std::fabs(coverage(stroke(box, width)) / area - 1.0) < 0.01);
    }
}

TEST_CASE("a filled polygon covers its true area, convex or not, either way round") {
    std::vector<Vec2> round = ellipse(150.0, 90.0, 120);
    CHECK(std::fabs(coverage(fill(round)) / (M_PI * 150.0 * 90.0) - 1.0) < 0.01);
    std::reverse(round.begin(), round.end());
    CHECK(std::fabs(coverage(fill(round)) / (M_PI * 150.0 * 90.0) - 1.0) < 0.01);
    const std::vector<Vec2> arrow{
        {100.0, 100.0}, {400.0, 100.0}, {250.0, 200.0}, {400.0, 300.0}, {100.0, 300.0}};
    CHECK(std::fabs(coverage(fill(arrow)) / (300.0 * 200.0 - 0.5 * 200.0 * 150.0) - 1.0) < 0.01);
}
