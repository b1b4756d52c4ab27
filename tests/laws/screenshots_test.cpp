#include "ui/subject/answer_row.hpp"
#include "ui/subject/window.hpp"
#include "tests/support/program.hpp"
#include "tests/support/window_session.hpp"

using Names = std::set<std::string>;

// The pictures that `palpate screenshots` makes of a protocol, beside what it asks for and what a
// session's window shows.

namespace {

/// Answers in words: pictures of objects have another order in each file.
constexpr const char* kYesOrNo = "\n[response]\nkind = \"yes_no\"\nquestion = \"Was it round?\"\n";

/// The pictures of a protocol by the names of their screens, byte for byte.
std::map<std::string, std::string> pictures_of(const std::string& protocol,
                                               const Words& more = {}) {
    const TemporaryFolder folder;
    write(folder.file("p.toml"), protocol);
    ran(joined({"screenshots", "--protocol", folder.file("p.toml"), "-o", folder.file("shots"),
                "--width", "640", "--height", "480"},
               more));
    std::map<std::string, std::string> pictures;
    for (const auto& entry : std::filesystem::directory_iterator(folder.file("shots"))) {
        pictures[entry.path().stem().string()] = slurp(entry.path());
    }
    return pictures;
}

Names names_of(const std::map<std::string, std::string>& pictures) {
    Names names;
    for (const auto& [name, bytes] : pictures) {
        names.insert(name);
    }
    return names;
}

/// The question's screen of a protocol, a file or a shipped one.
ScreenImage question_of(const std::string& protocol, int width, int height) {
    const TemporaryFolder folder;
    ran({"screenshots", "--protocol", protocol, "-o", folder.path().string(), "--width",
         std::to_string(width), "--height", std::to_string(height)});
    return read_png(folder.file("choose.png"));
}

constexpr std::uint32_t value(const ui::Colour& colour) {
    return static_cast<std::uint32_t>(colour.r) << 16U |
           static_cast<std::uint32_t>(colour.g) << 8U | colour.b;
}

/// How many pixels of a row have a colour.
int count_in_row(const ScreenImage& image, int y, std::uint32_t colour) {
    int found = 0;
    for (int x = 0; x < image.width; ++x) {
        found += image.at(x, y) == colour ? 1 : 0;
    }
    return found;
}

bool empty_row(const ScreenImage& image, int y) {
    return count_in_row(image, y, value(ui::kBackground)) == image.width;
}

/// Lines of text in a colour between two rows.
int lines_between(const ScreenImage& image, int top, int bottom, const ui::Colour& colour) {
    int lines = 0;
    bool inside = false;
    for (int y = top; y < bottom; ++y) {
        const bool ink = count_in_row(image, y, value(colour)) > 0;
        lines += ink && !inside ? 1 : 0;
        inside = ink || (inside && !empty_row(image, y));
    }
    return lines;
}

std::size_t differences(const ScreenImage& a, const ScreenImage& b) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) {
        found += a.pixels[i] == b.pixels[i] ? 0U : 1U;
    }
    return found;
}

int luminance(std::uint32_t pixel) {
    return static_cast<int>(pixel >> 16U) + static_cast<int>(pixel >> 8U & 255U) +
           static_cast<int>(pixel & 255U);
}

/// What stands on a card.
struct Drawn {
    double darker_right = 0.0;  ///< mean of the left half less that of the right one
    std::size_t shades = 0;     ///< how many colours
    double walls = 0.0;         ///< share of the card
};

Drawn drawn_on(const ScreenImage& image, const ui::Card& card) {
    Drawn drawn;
    std::set<std::uint32_t> shades;
    double sum[2] = {0.0, 0.0};
    int count[2] = {0, 0};
    int all = 0;
    int walls = 0;
    const auto left = static_cast<int>(card.corner.x) + 2;
    const auto top = static_cast<int>(card.corner.y) + 2;
    const auto width = static_cast<int>(card.size.x) - 4;
    const auto height = static_cast<int>(card.size.y) - 4;
    for (int y = top; y < top + height; ++y) {
        for (int x = left; x < left + width; ++x) {
            const std::uint32_t pixel = image.at(x, y);
            ++all;
            walls += pixel == value(ui::kWall) ? 1 : 0;
            if (pixel == value(ui::kWall) || luminance(pixel) > luminance(value(ui::kShape)) ||
                luminance(pixel) < 250) {
                continue;  // ground, walls and lines
            }
            shades.insert(pixel);
            const int half = x < left + width / 2 ? 0 : 1;
            sum[half] += luminance(pixel);
            ++count[half];
        }
    }
    drawn.darker_right = sum[0] / std::max(1, count[0]) - sum[1] / std::max(1, count[1]);
    drawn.shades = shades.size();
    drawn.walls = static_cast<double>(walls) / all;
    return drawn;
}

}  // namespace

TEST_CASE("a protocol has a picture of every screen that its sessions show, and of no other") {
    const Names always{"welcome", "ready",          "explore", "choose", "pause",
                       "trouble", "trouble_solved", "stopped", "end"};
    std::string text = replaced(four_trials(), "start_mm", "start_radius_mm = 0\nstart_mm");
    CHECK(names_of(pictures_of(text)) == always);
    text = replaced(text, "start_radius_mm = 0", "start_radius_mm = 5");
    CHECK(names_of(pictures_of(
              replaced(text, "[apparatus]\n", "[apparatus]\ndevice = \"mouse\"\n"))) == always);
    text = replaced(text, "break_every = 0", "break_every = 1");
    Names more = always;
    more.insert({"ready_away", "break"});
    CHECK(names_of(pictures_of(text)) == more);
    more.insert({"confidence", "feedback_right", "feedback_wrong"});
    CHECK(names_of(pictures_of(text + "\n[response]\nconfidence = true\nfeedback = \"all\"\n")) ==
          more);
}

TEST_CASE("what a protocol says is on the pictures of the screens that it is said on alone") {
    const std::string text =
        four_trials() + kYesOrNo + "confidence = true\n[instructions.en]\nend = \"Thanks\"\n";
    const auto before = pictures_of(text);
    const auto changed = [&](const std::string& from, const std::string& to) {
        const auto after = pictures_of(replaced(text, from, to));
        CHECK(names_of(after) == names_of(before));
        Names names;
        for (const auto& [name, bytes] : before) {
            if (after.at(name) != bytes) {
                names.insert(name);
            }
        }
        return names;
    };
    CHECK(changed("Was it round?", "Was it pointed?") == Names{"choose"});
    CHECK(changed("[response]\n", "[response]\nconfirm = true\n") == Names{"choose", "confidence"});
    CHECK(changed("end = \"Thanks\"", "explore = \"Stroke it\"\nend = \"Thanks\"") ==
          Names{"explore"});
    CHECK(changed("repetitions = 1", "repetitions = 3") ==
          Names{"explore", "ready", "ready_away", "welcome"});
    CHECK(changed("[response]\n", "[safety]\ndead_man = true\n[response]\n") ==
          Names{"explore", "ready"});
}

TEST_CASE("pictures speak the protocol's language, or the one that is asked for") {
    const auto speaking = [](const std::string& language) {
        return replaced(four_trials(), "[apparatus]\n",
                        "language = \"" + language + "\"\n[apparatus]\n") +
               kYesOrNo +
               "[instructions.en]\nready = \"Now\"\n[instructions.tr]\nready = \"Hazir\"\n";
    };
    const auto english = pictures_of(speaking("en"));
    const auto turkish = pictures_of(speaking("tr"));
    for (const char* screen : {"welcome", "ready", "choose", "pause"}) {
        CAPTURE(screen);
        CHECK(english.at(screen) != turkish.at(screen));
    }
    CHECK(pictures_of(speaking("en"), {"--language", "tr"}) == turkish);
    CHECK(pictures_of(speaking("tr"), {"--language", "en"}) == english);
}

TEST_CASE("in each language a picture is to the pixel what a session's window shows", "[window]") {
    EACH(language, as<std::string>{}, "en", "tr");
    const TemporaryFolder folder;
    std::string text =
        replaced(four_trials(), "[apparatus]\n",
                 "language = \"" + language + "\"\n[apparatus]\ndevice = \"mouse\"\n");
    text += kYesOrNo + std::string("confirm = true\n");
    write(folder.file("p.toml"), text);
    ran({"screenshots", "--protocol", folder.file("p.toml"), "-o", folder.file("shots")});
    WindowSession session(run_words(folder.file("p.toml"), "P1", folder.file("d.sqlite"),
                                    {"--device", "mouse", "--windowed"}),
                          {"SDL_RENDER_DRIVER=software"}, {});
    const auto shows = [&](const std::string& screen, const std::string& picture) {
        CAPTURE(picture);
        const auto window = session.wait_for_screen(screen);
        const ScreenImage wanted = read_png(folder.file("shots/" + picture + ".png"));
        ScreenImage shown;
        for (int look = 0; look < 100 && shown != wanted; ++look) {
            pause(0.1);
            shown = session.hand().image(window);
        }
        CHECK(shown.width == wanted.width);
        CHECK(shown.height == wanted.height);
        CHECK(differences(shown, wanted) == 0);
    };
    shows("welcome", "welcome");
    session.press_at("welcome", "space");
    shows("ready", "ready");
    session.press_at("ready", "space");
    shows("explore", "explore");  // once one may answer
    session.press_at("explore", "space");
    session.wait_for_screen("question");
    pause(0.4);  // its guard time
    session.hand().key("2");
    shows("question", "choose");
    session.hand().chord("p");
    session.press_at("question", "Return");
    shows("pause", "pause");
    session.hand().chord("p");
    session.press_at("ready", "space");
    session.press_at("explore", "Escape");
    shows("trouble", "stopped");
    CHECK(session.program().ended_by(SIGTERM) == 3);
}

TEST_CASE("patches are drawn in the light from the left, on a block, and from where is said") {
    const ScreenImage image = question_of("patch_friction", 1280, 800);
    const std::string order =
        palpate_command({"sequence", "patch_friction", "--participant", "P1"}).out;
    std::istringstream from_left(order.substr(order.find("left to right: ") + 15));
    std::map<std::string, std::size_t> at;
    for (std::size_t i = 0; i < 4; ++i) {
        std::string shape;
        from_left >> shape;
        at[shape] = i;
    }
    REQUIRE(at.size() == 4);
    const std::vector<ui::Card> cards = ui::lay_out_cards(4, {1280, 800});
    std::vector<Drawn> drawn;
    for (const ui::Card& card : cards) {
        drawn.push_back(drawn_on(image, card));
        CAPTURE(drawn.size(), drawn.back().darker_right, drawn.back().shades);
        CHECK(drawn.back().walls > 0.03);
    }
    CHECK(drawn[at["concave"]].darker_right < -40.0);
    CHECK(std::abs(drawn[at["flat"]].darker_right) < 10.0);
    CHECK(drawn[at["convex"]].darker_right > 40.0);
    for (const char* curved : {"concave", "saddle", "convex"}) {
        CHECK(drawn[at[curved]].shades > drawn[at["flat"]].shades + 20);
    }
    const ScreenImage plane = question_of(kFourTrials, 1280, 800);
    const auto said = [](const ScreenImage& of) {
        return lines_between(of, 608, 720, ui::kQuiet);
    };
    CHECK(said(plane) == 1);  // which keys
    CHECK(said(image) == 2);
}

TEST_CASE("the frame of the marked answer stands clear of a question of two lines") {
    const auto [width, height] =
        GENERATE(std::pair{1280, 800}, std::pair{800, 600}, std::pair{1920, 1080});
    CAPTURE(width, height);
    const TemporaryFile file("p.toml");
    write(file, four_trials() +
                    "\n[response]\nquestion = \"Which of the two shapes below was the one that "
                    "you have just felt with the handle?\"\n");
    const ScreenImage image = question_of(file, width, height);
    int frame = 0;
    while (frame < height && count_in_row(image, frame, value(ui::kAccent)) < width / 10) {
        ++frame;
    }
    REQUIRE(frame < height / 2);
    CHECK(lines_between(image, 0, frame, ui::kText) == 2);
    CHECK(empty_row(image, frame - 1));
    CHECK(empty_row(image, frame - 2));
}
