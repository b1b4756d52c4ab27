#pragma once

#include "tests/support/child.hpp"
#include "tests/support/rig_file.hpp"
#include "tests/support/window_session.hpp"

/// A board on a pseudo-terminal whose handle nobody holds, and an operator who types and brings it.
namespace palpate::tests {

/// The place of the last "Bring the handle to (X, Y) mm" as the emulator takes it: "X,Y", in space
/// "X,Y,Z".
inline std::string last_place(const std::string& text) {
    const std::size_t mark = text.rfind("mark (");
    std::string place =
        behind(text.substr(mark != std::string::npos ? mark : text.rfind("to (")), "(", ")");
    std::erase(place, ' ');
    return place;
}

/// An emulated board at a port, and somebody who types to it.
class TypedBoard {
public:
    /// @param words  of `palpate haply-emulator`
    TypedBoard(const TemporaryFolder& folder, const std::string& words)
        : word_((words.find("--open") != std::string::npos ? "board:" : "haply:") +
                folder.file("board")),
          emulator_(
              folder, "hand", "haply-emulator --link '" + folder.file("board") + "' " + words) {
        type("");
        REQUIRE(eventually([&] { return std::filesystem::exists(folder.file("board")); }));
    }
    [[nodiscard]] std::string word() const { return word_; }
    void type(const std::string& line) { emulator_.type(line); }
    void signal(int number) { emulator_.program().signal(number); }
    [[nodiscard]] std::string out() { return emulator_.program().out(); }

    /// What the board says of its motors now, and a Haply board of its resets.
    [[nodiscard]] std::string said() {
        const std::size_t before = out().size();
        type("motors");
        std::string said;
        CHECK(eventually([&] {
            said = out().substr(before);
            return said.find("mN m\n") != std::string::npos;
        }));
        return said;
    }
    /// What the motors give now, as the board says: "0, 0, 0".
    [[nodiscard]] std::string motors() { return behind(said(), "give ", " mN m"); }

protected:
    /// The example of a device that is a program, at a UDP port.
    TypedBoard(const TemporaryFolder& folder, std::uint16_t port)
        : word_("board:udp:127.0.0.1:" + std::to_string(port)),
          emulator_(folder, "hand", std::to_string(port), {}, PALPATE_UDP_DEVICE) {
        type("");
    }

private:
    std::string word_;
    TypedTo emulator_;
};

/// One whose handle nobody holds.
class FreeBoard : public TypedBoard {
public:
    explicit FreeBoard(const TemporaryFolder& folder, const std::string& words = "")
        : TypedBoard(folder, "--free " + words) {}
    /// The example at a UDP port, which does not say what it did.
    FreeBoard(const TemporaryFolder& folder, std::uint16_t port)
        : TypedBoard(folder, port), silent_(true) {}

    /// A place, where it has come then, or what else the emulator takes.
    void bring(const std::string& line) {
        const std::size_t before = out().size();
        type(line);
        CHECK((silent_ || eventually([&] { return out().size() > before; })));
        tests::pause(0.2);  // it lies still, and the program has seen it there
        if (is_held_ && line != kHold) {
            bring(kHold);
        }
    }
    /// By somebody who does not let go, wherever they bring it.
    void hold() {
        is_held_ = true;
        bring(kHold);
    }

private:
    static constexpr const char* kHold = "hold";

    bool is_held_ = false;
    bool silent_ = false;
};

/// Pulls the plug of a board; another may come in its place.
inline void unplug(const TemporaryFolder& folder, std::unique_ptr<FreeBoard>& board) {
    board.reset();
    std::filesystem::remove(folder.file("board"));
    std::filesystem::remove(folder.file("hand"));
}

/// Does what the program asks for until it has ended or shows `seen`.
inline void operate(TypedTo& operated,
                    FreeBoard& board,
                    const std::string& seen = "no such words") {
    std::size_t yes = 0;
    std::size_t brought = 0;
    CHECK(eventually([&] {
        const std::string out = operated.program().out();
        if (count_of(out, "Type yes:") > yes) {
            ++yes;
            operated.type("yes");
        }
        if (count_of(out, "Bring the handle to") > brought) {
            ++brought;
            board.bring(last_place(out.substr(out.rfind("Bring the handle to"))));
            operated.type("");
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return !operated.program().running() || out.find(seen) != std::string::npos;
    }));
}

/// A busy machine left the board, or the program, without its turn.
inline bool starved(const std::string& error) {
    return std::ranges::any_of(
        Words{"stopped answering", "switched its motors off", "falls silent", "runs wrong",
              "does not answer", "too long for a force", "late too often", "became later",
              "is gone", "left the workspace"},
        [&](const std::string& said) { return error.find(said) != std::string::npos; });
}

/// What a command comes to that the operator at the desk sees through. A busy machine may leave the
/// board without its turn in the middle of a pulse: the handle is brought back, and it is run
/// again.
inline Finished operated(const TemporaryFolder& folder,
                         FreeBoard& board,
                         const std::string& words,
                         const std::string& home = "0,89.3") {
    for (int attempt = 0;; ++attempt) {
        static int number = 0;
        TypedTo program(folder, fmt::format("desk{}", ++number), words, {"SDL_VIDEODRIVER=dummy"});
        operate(program, board);
        const Finished end = program.program().wait();
        if (attempt == 8 || !starved(end.error)) {
            return end;
        }
        board.bring(home);
    }
}

/// What `palpate doctor` says of a device, until `part` is in it: a busy machine may leave a board
/// without its turn.
inline std::string doctored(const TemporaryFolder& folder,
                            const std::string& device,
                            const std::string& calibration,
                            const std::string& part = "") {
    std::string said;
    for (int i = 0; i == 0 || (i < 20 && said.find(part) == std::string::npos); ++i) {
        said =
            behind(palpate_command({"doctor", "--device", device, "--calibration", calibration,
                                    "--seconds", "0.05", "--json", "--db", folder.file("d.sqlite")})
                       .out,
                   "", "kinematics");
    }
    return said;
}

/// Of a session that counts, although the board is emulated.
inline std::string real_words(const TemporaryFolder& folder,
                              const FreeBoard& board,
                              const std::string& rig) {
    return ran_words(folder, board.word()) + " --kind real --calibration '" + rig + "'";
}

/// A session in a window, as an operator opens it with `words`; a busy machine may need more tries.
struct OpenedSession {
    /// @param home      where the handle is before each
    /// @param replaced  a file that somebody writes over with `other` at the first question
    OpenedSession(const TemporaryFolder& folder,
                  FreeBoard& board,
                  const std::string& words,
                  const std::string& home = "0,89.3",
                  const std::string& replaced = "",
                  const std::string& other = "") {
        const std::string text = slurp(replaced);
        for (int attempt = 0; attempt < 8 && !(run && program().running()); ++attempt) {
            board.bring(home);
            if (!replaced.empty()) {
                write(replaced, text);
            }
            run = std::make_unique<TypedTo>(folder, fmt::format("run{}", attempt), words,
                                            shown_on(screen.display()));
            if (!replaced.empty()) {
                CHECK(program().says("Type yes:"));
                write(replaced, other);
            }
            operate(*run, board, "If it ends early");
        }
    }
    [[nodiscard]] Process& program() const { return run->program(); }
    [[nodiscard]] std::string title() { return hand.find_window("palpate: ").title; }
    /// Waits for a screen, and gives its window the keyboard.
    void wait_for(const std::string& name) {
        CAPTURE(program().out(), program().error());
        hand.wait_for_window("palpate: " + name, WindowSession::kPatience);
    }
    /// Presses what goes on at each screen until `name` is shown, or the program has ended.
    void press_up_to(const std::string& name) {
        CHECK(eventually([&] {
            const bool there = title() == "palpate: " + name || !program().running();
            if (!there) {
                press_on(hand);
            }
            return there;
        }));
    }
    /// By the experimenter, at the window.
    Finished end() {
        for (int i = 0; i < 40 && program().running(); ++i) {
            hand.focus(hand.find_window("palpate: "));
            hand.chord("q");
            pause(0.2);
            hand.key("y");
            pause(0.2);
        }
        return program().wait();
    }

    Xvfb screen{1280, 800};
    XHand hand{screen.display()};
    std::unique_ptr<TypedTo> run;
};

}  // namespace palpate::tests
