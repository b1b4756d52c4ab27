#pragma once

#include "tests/support/std.hpp"

namespace palpate::bench {

/// A word of the command line that means nothing: a sentence for its author, exit code 2.
class WrongWord : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The words after a command. Every word must be taken, or `finish` refuses.
class Words {
public:
    explicit Words(std::vector<std::string> words) : words_(std::move(words)) {}

    /// Takes `name` if it is there.
    [[nodiscard]] bool flag(const std::string& name);
    /// Takes `name VALUE`; `otherwise` if it is not there.
    [[nodiscard]] std::string value(const std::string& name, const std::string& otherwise = {});
    /// Takes `name NUMBER`. @throws WrongWord if it is not from `min` to `max`
    [[nodiscard]] double number(const std::string& name, double otherwise, double min, double max);
    /// @throws WrongWord for a word that nobody took, and for --peers where this build has none
    void finish() const;

private:
    std::vector<std::string> words_;
    bool peers_ = false;
};

/// What a command takes says the table of main.cpp. @return exit code
int nasty_command(Words words);
int contact_command(Words words);
int scaling_command(Words words);
int passivity_command(Words words);
int servo_command(Words words);
int friction_command(Words words);
int guard_command(Words words);
int data_command(Words words);
int procedure_command(Words words);

/// A file for results, opened before the long run that makes them. Without a name there is none,
/// and what is written to it is forgotten.
class Output : public std::ofstream {
public:
    /// @throws WrongWord if it cannot be written
    explicit Output(std::string name, const char* head = "");
    /// @throws std::runtime_error if not all of it was written
    void finish();

private:
    std::string name_;
};

}  // namespace palpate::bench
