#include "ui/subject/words.hpp"

namespace palpate::ui {
namespace {

constexpr Words kEnglish{
    .welcome = "Welcome",
    .welcome_back = "Welcome back",
    .you_feel = "You will feel objects that you cannot see.",
    .you_choose = "After each one, say which of the pictures it was.",
    .pointer_is_handle = "The pointer is the handle; it stays hidden while you feel.",
    .take_time = "Take the time you need.",
    .trials = "{0} trials, with breaks.",
    .trials_resumed = "The session goes on. {0} trials, with breaks.",
    .begin = "Press Space to begin",
    .trial = "Trial {0} of {1}",
    .practice_trial = "Practice: trial {0} of {1}",
    .ready = "Ready?",
    .hold_handle = "Hold the handle. It starts above the tip of the object.",
    .press_to_feel = "Press Space to feel the object",
    .hold_to_feel = "Hold Space down as long as you feel the object",
    .feel = "Feel the object",
    .both_sides = "Go along both sides, as often as you like.",
    .decide_soon = "Please decide soon",
    .keep_down = "Keep Space down; without it there is no force.",
    .space_when_known = "Press Space when you know its shape",
    .enter_when_known = "Press Enter when you know its shape",
    .which = "Which one was it?",
    .choose = "Press 1 to {0}, or click a picture, or use the arrows and Enter",
    .observer_chooses = "The simulated observer is choosing",
    .rest = "Time for a break",
    .let_go = "Let go of the handle and rest your hand.",
    .next_trial = "Next: trial {0} of {1}",
    .wait = "You can go on in {0} s",
    .go_on = "Press Space to go on",
    .moment = "One moment, please",
    .can_go_on = "We can go on",
    .help_comes = "The experimenter will help.",
    .thank_you_for_waiting = "Thank you for waiting.",
    .for_experimenter = "For the experimenter: ",
    .end = "That was all. Thank you!",
    .tell_experimenter = "Please tell the experimenter. Space closes this window.",
    .stop_question = "Experimenter: press Y to stop the session, any other key to go on",
};

constexpr Words kTurkish{
    .welcome = "Hoş geldiniz",
    .welcome_back = "Tekrar hoş geldiniz",
    .you_feel = "Göremediğiniz nesneleri elinizle hissedeceksiniz.",
    .you_choose = "Her birinden sonra, hangi resimdeki nesne olduğunu seçin.",
    .pointer_is_handle = "İmleç tutamak yerine geçer; siz hissederken gizli kalır.",
    .take_time = "İstediğiniz kadar zaman ayırın.",
    .trials = "{0} deneme var, aralarda mola verilir.",
    .trials_resumed = "Oturum devam ediyor. {0} deneme var, aralarda mola verilir.",
    .begin = "Başlamak için boşluk tuşuna basın",
    .trial = "Deneme {0} / {1}",
    .practice_trial = "Alıştırma: deneme {0} / {1}",
    .ready = "Hazır mısınız?",
    .hold_handle = "Tutamağı tutun. Nesnenin tepesinin üstünden başlar.",
    .press_to_feel = "Nesneyi hissetmek için boşluk tuşuna basın",
    .hold_to_feel = "Nesneyi hissettiğiniz sürece boşluk tuşunu basılı tutun",
    .feel = "Nesneyi hissedin",
    .both_sides = "İki kenarı boyunca istediğiniz kadar gezinin.",
    .decide_soon = "Lütfen kararınızı verin",
    .keep_down = "Boşluk tuşunu basılı tutun; bırakırsanız kuvvet kesilir.",
    .space_when_known = "Şeklini anladığınızda boşluk tuşuna basın",
    .enter_when_known = "Şeklini anladığınızda Enter tuşuna basın",
    .which = "Hangisiydi?",
    .choose =
        "1 ile {0} arasında bir tuşa basın, bir resme tıklayın ya da okları ve Enter'ı kullanın",
    .observer_chooses = "Benzetilen gözlemci seçiyor",
    .rest = "Mola zamanı",
    .let_go = "Tutamağı bırakın ve elinizi dinlendirin.",
    .next_trial = "Sıradaki: deneme {0} / {1}",
    .wait = "{0} s sonra devam edebilirsiniz",
    .go_on = "Devam etmek için boşluk tuşuna basın",
    .moment = "Bir dakika, lütfen",
    .can_go_on = "Devam edebiliriz",
    .help_comes = "Deneyi yürüten kişi yardım edecek.",
    .thank_you_for_waiting = "Beklediğiniz için teşekkürler.",
    .for_experimenter = "Deneyi yürüten için: ",
    .end = "Hepsi bu kadar. Teşekkürler!",
    .tell_experimenter = "Lütfen deneyi yürütene haber verin. Boşluk tuşu bu pencereyi kapatır.",
    .stop_question =
        "Deneyi yürüten: oturumu bitirmek için Y'ye, sürdürmek için başka bir tuşa basın",
};

}  // namespace

const Words& words_in(protocols::Language language) noexcept {
    return language == protocols::Language::tr ? kTurkish : kEnglish;
}

}  // namespace palpate::ui
