#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "tests/bench/commands.hpp"

namespace {

constexpr const char* kUsage =
    "palpate bench COMMAND\n"
    "  contact [--peers] [--seconds S] [--csv FILE] [--svg FILE]\n"
    "            closest points: time and error of every method on objects A to D\n"
    "  nasty [--peers] [--csv FILE]\n"
    "            wrong answers to 2223 queries that break closest-point solvers\n"
    "  scaling [--csv FILE]\n"
    "            time of a tick on outlines of 2 to 100,000 curves\n"
    "  procedure [--csv FILE]\n"
    "            time in which QUEST+ chooses from 20,000 parameter cells\n";

}  // namespace

int main(int count, char** arguments) {
    using namespace palpate::bench;
    std::vector<std::string> words(arguments + 1, arguments + count);
    try {
        if (words.empty()) {
            throw WrongWord("say which: contact, nasty, scaling or procedure");
        }
        const std::string command = words.front();
        words.erase(words.begin());
        if (command == "--help" || command == "-h") {
            std::cout << kUsage;
            return 0;
        }
        if (command == "contact") {
            return contact_command(words);
        }
        if (command == "nasty") {
            return nasty_command(words);
        }
        if (command == "scaling") {
            return scaling_command(words);
        }
        if (command == "procedure") {
            return procedure_command(words);
        }
        throw WrongWord("there is no benchmark \"" + command +
                        "\": there are contact, nasty, scaling and procedure");
    } catch (const WrongWord& wrong) {
        std::cerr << "palpate bench: " << wrong.what() << "\n" << kUsage;
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "palpate bench: " << error.what() << "\n";
        return 1;
    }
}
