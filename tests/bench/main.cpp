#include <iostream>

#include "tests/bench/commands.hpp"

namespace {

using namespace palpate::bench;

struct Command {
    const char* name;
    int (*run)(Words words);
    const char* usage;
};

constexpr Command kCommands[] = {
    {"contact", contact_command,
     "  contact [--peers] [--objects LETTERS] [--seconds S] [--csv FILE] [--svg FILE]\n"
     "  contact --against BINARY ...       by how much this build differs from another "
     "palpate_bench\n"
     "  contact --from FILE --svg FILE     draws a table again\n"
     "            closest points and ticks: time, instructions and error of every method on "
     "objects\n"
     "            A to E and on surfaces, S: ABCDES\n"},
    {"nasty", nasty_command,
     "  nasty [--peers] [--csv FILE]\n"
     "            wrong answers to 2223 queries that break closest-point solvers\n"},
    {"scaling", scaling_command,
     "  scaling [--csv FILE]\n"
     "            time of a tick on outlines of 2 to 100,000 curves\n"},
    {"friction", friction_command,
     "  friction [--csv FILE] [--svg FILE]\n"
     "            every law of friction: jumps, rate, force held at rest, chatter, drift, energy, "
     "ns\n"},
    {"passivity", passivity_command,
     "  passivity [--csv FILE]\n"
     "            the stiffest wall on which the simulated pantograph rests, against the bound\n"},
    {"servo", servo_command,
     "  servo [--rounds N] [--seconds S] [--spin SHARE] [--csv FILE]\n"
     "            how late the servo thread wakes, against cyclictest if it is installed;\n"
     "            what logging costs it; late ticks at 1, 4 and 10 kHz\n"},
    {"procedure", procedure_command,
     "  procedure [--csv FILE]\n"
     "            time in which QUEST+ chooses from 20,000 parameter cells\n"},
    {"data", data_command,
     "  data [--peers] [--trials N] [--seconds S] [--cores 1|2] [--csv FILE]\n"
     "            traces: simulate, ingest, queries, replay, verify; against rows in SQLite, CSV "
     "and\n"
     "            HDF5; on one core unless two are asked for\n"},
    {"guard", guard_command,
     "  guard [--kills N] [--csv FILE], or --hold SECONDS [--busy PROGRAMS], or --stops N\n"
     "            from palpate's death (kill -9) or stop to zero torque at an emulated board\n"},
};

std::string usage() {
    std::string text = "palpate bench COMMAND\n";
    for (const Command& command : kCommands) {
        text += command.usage;
    }
    return text;
}

std::string names() {
    std::string text;
    for (const Command& command : kCommands) {
        text += text.empty() ? command.name : std::string(", ") + command.name;
    }
    return text;
}

int run(std::vector<std::string> words) {
    if (words.empty()) {
        throw WrongWord("say which: " + names());
    }
    const std::string name = words.front();
    words.erase(words.begin());
    if (name == "--help" || name == "-h") {
        std::cout << usage();
        return 0;
    }
    for (const Command& command : kCommands) {
        if (name == command.name) {
            return command.run(Words(words));
        }
    }
    throw WrongWord("there is no benchmark \"" + name + "\": there are " + names());
}

}  // namespace

int main(int count, char** arguments) {
    try {
        return run(std::vector<std::string>(arguments + 1, arguments + count));
    } catch (const WrongWord& wrong) {
        std::cerr << "palpate bench: " << wrong.what() << "\n" << usage();
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "palpate bench: " << error.what() << "\n";
        return 1;
    }
}
