#include "ui/subject/words.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/safety/trip.hpp"
#include "protocols/session/operator_desk.hpp"
#include "protocols/session/trouble.hpp"

namespace palpate::ui {
namespace {

constexpr Words kEnglish{
    .welcome = "Welcome",
    .welcome_back = "Welcome back",
    .you_feel = "You will feel objects that you cannot see.",
    .you_feel_two = "You will feel objects that you cannot see, two in each trial.",
    .you_choose = "After each one, say which of the pictures it was.",
    .a_question = "After each one you will be asked a question about it.",
    .which_of_both = "After the second one you will be asked about the two.",
    .pointer_is_handle = "The pointer is the handle; it stays hidden while you feel.",
    .take_time = "Take the time you need.",
    .one_trial = "One trial is left.",
    .goes_on = "The session goes on.",
    .trials = "{0} trials.",
    .practice_first = "{0} for practice, then {1} more.",
    .breaks = "There are breaks.",
    .begin = "Press Space to begin",
    .trial = "Trial {0} of {1}",
    .practice_trial = "Practice {0} of {1}",
    .first_of_two = "First of two",
    .second_of_two = "Second of two",
    .ready = "Ready?",
    .hold_handle = "Hold the handle. It starts outside the object.",
    .press_to_feel = "Press Space to feel the object",
    .hold_to_feel = "Hold Space down as long as you feel the object",
    .bring_to_start = "Bring the handle to the start: the dot into the ring",
    .bring_to_height = "Bring the handle to the start's height: the right dot onto its line",
    .bring_out = "An object reaches into the ring there: bring the dot to its middle",
    .feel = "Feel the object",
    .along_surface = "Go along its surface, as often as you like.",
    .decide_soon = "Please decide soon",
    .keep_down = "Keep Space down; without it there is no force.",
    .space_when_known = "Press Space when you know its shape",
    .enter_when_known = "Press Enter when you know its shape",
    .space_when_felt = "Press Space when you have felt it enough",
    .enter_when_felt = "Press Enter when you have felt it enough",
    .which = "Which one was it?",
    .choose = "Press 1 to {0}, or click a picture, or use the arrows and Enter",
    .seen_from_above = "Seen from in front and above, in a light from the left",
    .observer_chooses = "The simulated observer is choosing",
    .first_or_second = "The first or the second?",
    .first = "First",
    .second = "Second",
    .no = "No",
    .yes = "Yes",
    .least = "least",
    .most = "most",
    .choose_of_two = "Press 1 or 2, or click an answer, or use the arrows and Enter",
    .choose_level = "Press 1 to {0}, or click a number, or use the arrows and Enter",
    .confirm = "Enter, or the same one again, confirms; another one changes the answer",
    .how_sure = "How sure are you?",
    .a_guess = "a guess",
    .certain = "certain",
    .right = "Correct",
    .wrong = "Wrong",
    .rest = "Time for a break",
    .let_go = "Bring the handle home, let go of it and rest your hand.",
    .home_first = "First bring the handle home and let go of it",
    .next_trial = "Next: trial {0} of {1}",
    .next_practice = "Next: practice {0} of {1}",
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
    .mark_question = "Experimenter: press Y if this trial shall not count, any other key to go on",
    .mark_last_question =
        "Experimenter: press Y if the last trial shall not count, any other key to go on",
    .pause_comes = "Experimenter: the pause comes before the next trial",
    .no_pause = "Experimenter: no pause after all",
    .session_over = "Experimenter: the session is over; palpate mark marks its trials",
    .keyboard_elsewhere = "Experimenter: keys go to another window; click into this one",
    .marked = "Experimenter: trial {0} of {1} does not count",
    .practice_marked = "Experimenter: practice {0} of {1} does not count",
    .nothing_to_mark = "Experimenter: nothing to mark",
    .runs_again = "and runs again",
    .not_again = "and is not run again",
    .pause = "Pause",
    .please_wait = "Please wait for the experimenter.",
    .end_of_pause = "Experimenter: the terminal says how to go on",
};

constexpr Words kTurkish{
    .welcome = "Hoş geldiniz",
    .welcome_back = "Tekrar hoş geldiniz",
    .you_feel = "Göremediğiniz nesneleri elinizle hissedeceksiniz.",
    .you_feel_two = "Göremediğiniz nesneleri hissedeceksiniz, her denemede iki tane.",
    .you_choose = "Her birinden sonra, hangi resimdeki nesne olduğunu seçin.",
    .a_question = "Her birinden sonra size onunla ilgili bir soru sorulacak.",
    .which_of_both = "İkincisinden sonra size ikisiyle ilgili bir soru sorulacak.",
    .pointer_is_handle = "İmleç tutamak yerine geçer; siz hissederken gizli kalır.",
    .take_time = "İstediğiniz kadar zaman ayırın.",
    .one_trial = "Bir deneme kaldı.",
    .goes_on = "Oturum devam ediyor.",
    .trials = "{0} deneme var.",
    .practice_first = "Önce {0} alıştırma, sonra {1} deneme var.",
    .breaks = "Aralarda mola verilir.",
    .begin = "Başlamak için boşluk tuşuna basın",
    .trial = "Deneme {0} / {1}",
    .practice_trial = "Alıştırma {0} / {1}",
    .first_of_two = "İki nesneden birincisi",
    .second_of_two = "İki nesneden ikincisi",
    .ready = "Hazır mısınız?",
    .hold_handle = "Tutamağı tutun. Nesnenin dışından başlar.",
    .press_to_feel = "Nesneyi hissetmek için boşluk tuşuna basın",
    .hold_to_feel = "Nesneyi hissettiğiniz sürece boşluk tuşunu basılı tutun",
    .bring_to_start = "Tutamağı başlangıca getirin: noktayı halkanın içine",
    .bring_to_height = "Tutamağı başlangıç yüksekliğine getirin: sağdaki noktayı çizgiye",
    .bring_out = "Orada halkanın içine bir nesne uzanıyor: noktayı ortasına getirin",
    .feel = "Nesneyi hissedin",
    .along_surface = "Yüzeyi boyunca istediğiniz kadar gezinin.",
    .decide_soon = "Lütfen kararınızı verin",
    .keep_down = "Boşluk tuşunu basılı tutun; bırakırsanız kuvvet kesilir.",
    .space_when_known = "Şeklini anladığınızda boşluk tuşuna basın",
    .enter_when_known = "Şeklini anladığınızda Enter tuşuna basın",
    .space_when_felt = "Yeterince hissettiğinizde boşluk tuşuna basın",
    .enter_when_felt = "Yeterince hissettiğinizde Enter tuşuna basın",
    .which = "Hangisiydi?",
    .choose =
        "1 ile {0} arasında bir tuşa basın, bir resme tıklayın ya da okları ve Enter'ı kullanın",
    .seen_from_above = "Önden ve yukarıdan görünüş, ışık soldan geliyor",
    .observer_chooses = "Benzetilen gözlemci seçiyor",
    .first_or_second = "Birincisi mi, ikincisi mi?",
    .first = "Birinci",
    .second = "İkinci",
    .no = "Hayır",
    .yes = "Evet",
    .least = "en az",
    .most = "en çok",
    .choose_of_two = "1'e ya da 2'ye basın, bir yanıta tıklayın ya da okları ve Enter'ı kullanın",
    .choose_level =
        "1 ile {0} arasında bir tuşa basın, bir sayıya tıklayın ya da okları ve Enter'ı kullanın",
    .confirm =
        "Onaylamak için Enter'a basın ya da aynısını yeniden seçin; değiştirmek için başkasını",
    .how_sure = "Ne kadar eminsiniz?",
    .a_guess = "yalnızca tahmin",
    .certain = "kesinlikle eminim",
    .right = "Doğru",
    .wrong = "Yanlış",
    .rest = "Mola zamanı",
    .let_go = "Tutamağı yerine götürün, bırakın ve elinizi dinlendirin.",
    .home_first = "Önce tutamağı yerine götürün ve bırakın",
    .next_trial = "Sıradaki: deneme {0} / {1}",
    .next_practice = "Sıradaki: alıştırma {0} / {1}",
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
    .mark_question =
        "Deneyi yürüten: bu deneme sayılmayacaksa Y'ye, sürdürmek için başka bir tuşa basın",
    .mark_last_question =
        "Deneyi yürüten: son deneme sayılmayacaksa Y'ye, sürdürmek için başka bir tuşa basın",
    .pause_comes = "Deneyi yürüten: sıradaki denemeden önce ara verilecek",
    .no_pause = "Deneyi yürüten: ara verilmeyecek",
    .session_over = "Deneyi yürüten: oturum bitti; denemeleri palpate mark işaretler",
    .keyboard_elsewhere =
        "Deneyi yürüten: tuşlar başka bir pencereye gidiyor; bu pencereye tıklayın",
    .marked = "Deneyi yürüten: deneme {0} / {1} sayılmıyor",
    .practice_marked = "Deneyi yürüten: alıştırma {0} / {1} sayılmıyor",
    .nothing_to_mark = "Deneyi yürüten: işaretlenecek yanıt yok",
    .runs_again = "ve yinelenecek",
    .not_again = "ve yinelenmeyecek",
    .pause = "Ara",
    .please_wait = "Lütfen deneyi yürüteni bekleyin.",
    .end_of_pause = "Deneyi yürüten: nasıl sürdürüleceği terminalde yazıyor",
};

/// Of each trip, in their order; none is no trip.
constexpr std::array<std::string_view, static_cast<std::size_t>(engine::Trip::stopped) + 1>
    kTurkishTrips{
        "",
        "hesaplanan kuvvet bir sayı değildi: lütfen veritabanıyla birlikte bildirin",
        "nesne orada hesaplanamadı: lütfen veritabanıyla birlikte bildirin",
        "aygıtla bağlantı koptu: kablosunu ve güç kaynağını denetleyin",
        "aygıt yanıt vermiyor: kablosunu ve güç kaynağını denetleyin",
        "aygıt motorlarını kapattı: acil durdurma düğmesini serbest bırakın; kimse basmadıysa "
        "öteki programları kapatın ve kabloyu denetleyin",
        "aygıt olanaksız değerler gönderiyor: fişini çekin, bekleyin, yeniden takın",
        "tutamak çalışma alanından çıktı: ortaya geri getirin",
        "tutamağın konumu sıçradı: kodlayıcı kablolarını denetleyin ve yeniden kalibre edin",
        "bir kodlayıcı, tutamak dönerken ya da itilirken duruyor: kodlayıcıların kablolarını ve "
        "beslemesini denetleyin",
        "tutamak sınırdan hızlıydı: daha yavaş hareket edin; onu kimse bu kadar hızlı hareket "
        "ettirmediyse elinizi çekin, motorların ve kodlayıcıların kablolarını denetleyin",
        "kuvvet döngüsü çok sık gecikti: öteki programları kapatın; palpate doctor nedenini söyler",
        "aygıtın yanıtları bu sertlik için çok geç geliyor: bilgisayarın kendi girişini, çoklayıcı "
        "olmadan kullanın ve onu meşgul eden programları kapatın",
        "kuvvet, aldığından çok enerji verdi: sertliği azaltın ya da rate_hz değerini artırın",
        "tutamak tam kuvvete karşı hızlandı: elinizi çekin, motorların yönünü ve kablolarını "
        "denetleyin; doğruysalar daha yumuşak bastırın",
        "temas titreşti: tutamağı daha sıkı tutun ya da stiffness_n_per_m değerini azaltın",
        "motorlar ısı sınırında: soğumalarını bekleyin, daha az bastırın",
        "ekran ya da bu program durdu: öteki programları kapatın, ekranın kablosunu ve sunucusunu "
        "denetleyin",
        "kuvvet explore_timeout_s süresinden uzun sürdü: öteki programları kapatın ve bunu "
        "veritabanıyla birlikte bildirin",
        "katılımcı bıraktı: bitene dek tutamağı ve boşluk tuşunu bırakmayın",
        "katılımcının penceresi klavyeyi yitirdi, gizlendi ya da kapatılmak istendi: önündekini "
        "kaldırın, ara tuşlarıyla sürdürün",
        "kuvvet elle kesildi: deneyi yürütenin ara tuşlarıyla sürer"};

/// What a session says of its rig.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kTurkishRig{{
    {protocols::kAnother,
     "aygıt kimse bakmazken yeniden başladı, başka bir aygıt olabilir: deneyi yürüten sürdürür"},
    {protocols::kNotProved, "düzenek hakkında artık hiçbir şey bilinmiyor: yeniden sınanıyor"},
    {protocols::kProofComes,
     "kimse kuvvet hissetmeden önce tutamak sınanacak: şimdi onu kimse tutmasın, zayıf itmeler "
     "hareket ettirecek"},
    {protocols::kButtonGone, "durdurma düğmesi yok: yeniden takın"},
    {protocols::kButtonDown, "durdurma düğmesi basılı: serbest bırakın"},
}};

}  // namespace

std::string_view trip_in(protocols::Language language, std::string_view sentence) noexcept {
    if (language != protocols::Language::tr) {
        return sentence;
    }
    for (std::size_t i = 1; i < kTurkishTrips.size(); ++i) {
        if (sentence == explanation(static_cast<engine::Trip>(i))) {
            return kTurkishTrips[i];
        }
    }
    const auto* said = std::ranges::find(kTurkishRig, sentence,
                                         &std::pair<std::string_view, std::string_view>::first);
    return said == kTurkishRig.end() ? sentence : said->second;
}

const Words& words_in(protocols::Language language) noexcept {
    return language == protocols::Language::tr ? kTurkish : kEnglish;
}

}  // namespace palpate::ui
