// The whole server over sockets, with clients that behave and clients that do not.
#include "explorer/explorer.h"
#include "explorer/raw_client.h"
#include "explorer/workbench.h"

#include <fstream>
#include <gmock/gmock.h>

namespace nacre {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

/// Resident memory of this process in MiB.
double resident() {
  std::ifstream status("/proc/self/statm");
  double total = 0, pages = 0;
  status >> total >> pages;
  return pages * double(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

class ExplorerNetwork : public testing::Test {
protected:
  ExplorerNetwork() : explorer_({folder_.path(), {}, 0}), thread_([this] { explorer_.run(); }) {}
  ~ExplorerNetwork() override {
    explorer_.stop();
    thread_.join();
  }
  int port() { return explorer_.server().port(); }
  std::string token() { return explorer_.server().token(); }
  std::string host() { return "127.0.0.1:" + std::to_string(port()); }

  std::string get(const std::string& target, const std::string& fields = "") {
    RawClient client(port());
    client.send("GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\n" + fields + "\r\n");
    return client.http_answer();
  }
  /// A page that has said hello to nobody yet.
  std::unique_ptr<RawClient> page() {
    auto client = std::make_unique<RawClient>(port());
    EXPECT_THAT(client->upgrade(port(), token()), StartsWith("HTTP/1.1 101"));
    return client;
  }
  static json ask(RawClient& client, const json& request) {
    client.say(request.dump());
    for (;;) {
      const auto m = client.hear();
      if (!m) return nullptr;
      const json header = decode_answer(*m).header;
      if (header.value("id", -1) == request["id"] && !header.contains("progress")) return header;
    }
  }
  /// The server works for others.
  void expect_up() {
    const auto client = page();
    EXPECT_EQ(ask(*client, {{"id", 1}, {"type", "material"}, {"material", {{"text", "lambert"}}}})["kind"],
              "model");
  }

  ScratchFolder folder_;
  Explorer explorer_;
  std::thread thread_;
};

TEST_F(ExplorerNetwork, ThePageIsServedToItsOwnAddressAlone) {
  EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get("/?token=x"), HasSubstr("<!doctype html>"));
  EXPECT_THAT(get("/"), HasSubstr("no-referrer"));
  EXPECT_THAT(get("/nothing"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/../../etc/passwd"), StartsWith("HTTP/1.1 404"));
  RawClient rebound(port());
  rebound.send("GET / HTTP/1.1\r\nHost: evil.example:" + std::to_string(port()) + "\r\n\r\n");
  EXPECT_THAT(rebound.http_answer(), StartsWith("HTTP/1.1 403"));
  RawClient none(port());
  none.send("GET / HTTP/1.0\r\n\r\n");
  EXPECT_THAT(none.http_answer(), HasSubstr(" 403 "));
}

TEST_F(ExplorerNetwork, OriginAndTokenAreChecked) {
  RawClient wrong_origin(port()), wrong_token(port()), no_token(port()), right(port());
  EXPECT_THAT(wrong_origin.upgrade(port(), token(), "http://evil.example"), HasSubstr("evil.example"));
  EXPECT_THAT(wrong_token.upgrade(port(), std::string(32, '0')),
              AllOf(StartsWith("HTTP/1.1 403"), HasSubstr("token")));
  EXPECT_THAT(no_token.upgrade(port(), ""), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(right.upgrade(port(), token()), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(get("/ws?token=" + token()), StartsWith("HTTP/1.1 426"));
  RawClient upload(port());
  upload.send("POST /upload?name=a.brdf HTTP/1.1\r\nHost: " + host() + "\r\nContent-Length: 1\r\n\r\na");
  EXPECT_THAT(upload.http_answer(), StartsWith("HTTP/1.1 403"));
}

TEST_F(ExplorerNetwork, TwoPagesAtOnceGetTheirOwnAnswers) {
  const auto a = page(), b = page();
  const auto curves = [](int id, double reflectance) {
    return json{{"id", id},
                {"type", "curves"},
                {"kind", "theta_o"},
                {"points", 5},
                {"materials", {{{"text", "lambert:reflectance=" + std::to_string(reflectance)}}}}};
  };
  for (int i = 1; i <= 20; ++i) {
    a->say(curves(i, 0.25).dump());
    b->say(curves(i, 0.75).dump());
  }
  for (const auto& [client, reflectance] : {std::pair{a.get(), 0.25}, {b.get(), 0.75}}) {
    std::set<int> ids;
    for (int i = 0; i < 20; ++i) {
      const auto m = client->hear();
      ASSERT_TRUE(m);
      const DecodedAnswer d = decode_answer(*m);
      ids.insert(d.header["id"].get<int>());
      EXPECT_NEAR(d.arrays[1].data[0], reflectance / pi, 1e-6);
    }
    EXPECT_EQ(ids.size(), 20u);
  }
}

TEST_F(ExplorerNetwork, MalformedMessagesAreAnsweredAndThePageStays) {
  const auto client = page();
  for (const std::string bad : {"", "{", "[]", "null", "{\"id\": 3}", "{\"id\": 3, \"type\": \"nothing\"}",
                                "\x01\x02", "{\"id\": 3, \"type\": \"curves\", \"materials\": {\"a\": 1}}",
                                "{\"id\": 3, \"type\": \"sphere\", \"size\": 1e99}",
                                "{\"id\": 99999999999999999999999, \"type\": \"hello\"}"}) {
    client->say(bad);
    const auto m = client->hear();
    ASSERT_TRUE(m) << bad;
    EXPECT_TRUE(json::parse(m->bytes).contains("error")) << m->bytes;
  }
  client->send(RawClient::frame("\x80\x81", 2)); // a binary message: a page sends none
  const auto m = client->hear();
  ASSERT_TRUE(m);
  EXPECT_TRUE(json::parse(m->bytes).contains("error"));
  EXPECT_EQ(ask(*client, {{"id", 4}, {"type", "files"}, {"folder", ""}})["ok"], true);
}

TEST_F(ExplorerNetwork, MalformedFramesCloseThatConnectionAlone) {
  const auto unmasked = page(), not_utf8 = page(), reserved = page(), huge = page();
  unmasked->send(RawClient::frame("{}", 1, false));
  not_utf8->send(RawClient::frame("\xff\xff\xff"));
  reserved->send(RawClient::frame("x", 5));
  // A frame of an exabyte, of which nothing follows.
  huge->send(std::string("\x81\xff\x0f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14));
  EXPECT_FALSE(unmasked->hear());
  EXPECT_FALSE(not_utf8->hear());
  EXPECT_FALSE(reserved->hear());
  EXPECT_FALSE(huge->hear());
  RawClient garbage(port());
  garbage.send(std::string(100, '\x16') + "\r\n\r\n");
  garbage.http_answer();
  RawClient endless_header(port());
  endless_header.send("GET / HTTP/1.1\r\nA: " + std::string(1 << 20, 'a'));
  endless_header.http_answer();
  expect_up();
}

TEST_F(ExplorerNetwork, PagesVanishInTheMiddleOfEverything) {
  {
    RawClient half_header(port());
    half_header.send("GET /ws?tok");
    half_header.vanish();
    const auto half_frame = page(), half_answer = page(), long_work = page();
    half_frame->send(RawClient::frame(std::string(100000, 'x')).substr(0, 5000));
    half_frame->vanish();
    for (int i = 1; i < 40; ++i) // megabytes of answers that nobody takes
      half_answer->say(
          json{{"id", i}, {"type", "sphere"}, {"size", 256}, {"material", {{"text", "lambert"}}}}.dump());
    half_answer->vanish();
    long_work->say(json{
        {"id", 1},
        {"type", "object"},
        {"material", {{"text", "lambert"}}},
        {"samples", 0},
        {"width", 64},
        {"height", 64},
        {"environment",
         "white"}}.dump());
    ASSERT_TRUE(long_work->hear());
    long_work->vanish();
    RawClient half_upload(port());
    half_upload.send("POST /upload?token=" + token() + "&name=half.brdf HTTP/1.1\r\nHost: " + host() +
                     "\r\nContent-Length: 100000\r\n\r\nabc");
    half_upload.vanish();
  }
  expect_up();
  const auto client = page();
  EXPECT_TRUE(ask(*client, {{"id", 1}, {"type", "read"}, {"file", "upload:half.brdf"}}).contains("error"));
}

TEST_F(ExplorerNetwork, AnUploadIsAFileLikeOthers) {
  const std::string text = simple_brdf;
  RawClient client(port());
  client.send("POST /upload?token=" + token() + "&name=my%20file.brdf HTTP/1.1\r\nHost: " + host() +
              "\r\nContent-Length: " + std::to_string(text.size()) + "\r\n\r\n" + text);
  const std::string answer = client.http_answer();
  ASSERT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("upload:my file.brdf"));
  const auto p = page();
  EXPECT_EQ(
      ask(*p, {{"id", 1}, {"type", "material"}, {"material", {{"file", "upload:my file.brdf"}}}})["kind"],
      "user");
  EXPECT_EQ(ask(*p, {{"id", 2}, {"type", "read"}, {"file", "upload:my file.brdf"}})["text"], text);
  for (const std::string name : {"", "..%2Fx.brdf", ".x", "a%2Fb", "a%00b"}) {
    RawClient bad(port());
    bad.send("POST /upload?token=" + token() + "&name=" + name + " HTTP/1.1\r\nHost: " + host() +
             "\r\nContent-Length: 1\r\n\r\na");
    EXPECT_THAT(bad.http_answer(), StartsWith("HTTP/1.1 400")) << name;
  }
}

TEST_F(ExplorerNetwork, AGigabyteIsRefusedWithoutGrowing) {
  const double before = resident();
  const std::string block(1 << 20, 'x');
  {
    RawClient announced(port());
    announced.send("POST /upload?token=" + token() + "&name=big.binary HTTP/1.1\r\nHost: " + host() +
                   "\r\nContent-Length: 1073741824\r\n\r\n");
    EXPECT_THAT(announced.http_answer(), AllOf(StartsWith("HTTP/1.1 413"), HasSubstr("256 MiB")));
  }
  {
    // A length that is not said beforehand.
    RawClient chunked(port());
    chunked.send("POST /upload?token=" + token() + "&name=big.binary HTTP/1.1\r\nHost: " + host() +
                 "\r\nTransfer-Encoding: chunked\r\n\r\n");
    int sent = 0;
    while (sent < 1024 && chunked.send("100000\r\n") && chunked.send(block) && chunked.send("\r\n"))
      ++sent;
    EXPECT_LT(sent, 400) << "MiB";
  }
  {
    const auto client = page();
    std::string head("\x81\xff\0\0\0\0\x40\0\0\0\0\0\0\0", 14); // a message of 1 GiB
    client->send(head);
    int sent = 0;
    while (sent < 1024 && client->send(block))
      ++sent;
    EXPECT_LT(sent, 128) << "MiB";
  }
#ifndef __SANITIZE_ADDRESS__ // which keeps freed memory for a while
  EXPECT_LT(resident() - before, 100) << "MiB";
#endif
  expect_up();
}

// A browser shows a close code only where the connection was not reset before it came.
TEST_F(ExplorerNetwork, AMessageThatIsTooLargeIsToldSo) {
  const std::string block(1 << 20, 'x');
  for (const std::size_t mebibytes : {65, 80}) {
    const auto client = page();
    std::string head("\x81\xff\0\0\0\0\0\0\0\0\0\0\0\0", 14);
    for (std::size_t k = 0; k < 8; ++k)
      head[2 + k] = char(mebibytes << 20 >> (56 - 8 * k));
    client->send(head);
    for (std::size_t k = 0; k < mebibytes; ++k)
      ASSERT_TRUE(client->send(block)) << k << " of " << mebibytes << " MiB";
    EXPECT_FALSE(client->hear());
    EXPECT_EQ(client->close_code, 1009) << mebibytes << " MiB";
  }
  expect_up();
}

TEST_F(ExplorerNetwork, NamesInMessagesAreCut) {
  const auto client = page();
  const std::string name(1 << 20, 'n');
  int id = 0;
  for (const json& request :
       {json{{"type", name}}, json{{"type", "read"}, {"file", name}},
        json{{"type", "material"}, {"material", {{"text", name}}}},
        json{{"type", "export"}, {"material", {{"text", "lambert"}}}, {"format", name}},
        json{{"type", "material"}, {"material", {{"text", "lambert:" + name + "=1"}}}},
        json{{"type", "material"}, {"material", {{"brdf", {{"name", name}, {"source", "x"}}}}}},
        json{{"type", "material"},
             {"material", {{"name", "m"}, {"lobes", {{{"model", name}, {"parameters", {}}}}}}}},
        json{
            {"type", "furnace"}, {"material", {{"text", "lambert"}}}, {"parameter", std::string(60000, 'p')}},
        json{{"type", "write"}, {"file", name + ".brdf"}, {"text", ""}}}) {
    json whole = request;
    whole["id"] = ++id;
    const json answer = ask(*client, whole);
    ASSERT_TRUE(answer.contains("error")) << request.dump().substr(0, 80);
    EXPECT_LT(answer["error"]["message"].get<std::string>().size(), 1000u) << answer.dump().substr(0, 300);
  }
}

TEST_F(ExplorerNetwork, LongWorkDoesNotMakeASliderWait) {
  const auto client = page();
  client->say(json{
      {"id", 1},
      {"type", "object"},
      {"material", {{"text", "lambert"}}},
      {"samples", 0},
      {"width", 256},
      {"height", 256},
      {"environment",
       "white"}}.dump());
  ASSERT_TRUE(client->hear());
  const auto other = page();
  for (int id = 2; id < 12; ++id) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(ask(*other, {{"id", id},
                           {"type", "curves"},
                           {"slot", "s"},
                           {"kind", "albedo"},
                           {"materials", {{{"text", "ggx_conductor"}}}}})["ok"],
              true);
    // Milliseconds, on a machine with others on it.
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 2);
  }
  client->say(R"({"id": 20, "type": "cancel", "of": 1})");
  bool cancelled = false, answered = false;
  while (!cancelled || !answered) {
    const auto m = client->hear();
    ASSERT_TRUE(m);
    const json header = decode_answer(*m).header;
    cancelled |= header["id"] == 1 && header.value("cancelled", false);
    answered |= header["id"] == 20;
  }
  // The picture is there after its end.
  EXPECT_EQ(ask(*client, {{"id", 21}, {"type", "inspect"}, {"of", 1}, {"x", 128}, {"y", 128}})["material"],
            "lambert");
}

/// Ends, but takes some milliseconds a value.
constexpr const char* slow_brdf =
    "analytic\n::begin shader\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n"
    "  float x = 0;\n  for (int i = 0; i < 300; i++)\n"
    "    for (int j = 0; j < 300; j++) x += sqrt(L.z + x);\n"
    "  return vec3(x * 1e-6);\n}\n::end shader\n";

/// All that a page may ask of a material at once, in several views of each kind.
std::vector<json> everything_of(const json& material) {
  std::vector<json> requests;
  for (const char* type : {"sphere", "slice", "furnace", "lobe3d", "curves", "material", "compile", "export",
                           "validate", "fit", "object"})
    for (int view = 0; view < 2; ++view)
      requests.push_back({{"id", int(requests.size()) + 1},
                          {"type", type},
                          {"slot", fmt::format("{}{}", type, view)},
                          {"material", material},
                          {"materials", {material}},
                          {"brdf", material["brdf"]},
                          {"kind", view ? "albedo" : "phi"},
                          {"format", "json"},
                          {"measured", material},
                          {"models", {"lambert"}}});
  return requests;
}

class ExplorerWithASlowShader : public ExplorerNetwork {
protected:
  const json material_{{"brdf", {{"name", "slow.brdf"}, {"source", slow_brdf}}}};
  static double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
};

TEST_F(ExplorerWithASlowShader, OtherPagesDoNotWaitForItNorItsOwnForFiles) {
  const auto slow = page(), other = page();
  for (const json& request : everything_of(material_))
    slow->say(request.dump());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  for (const auto& client : {other.get(), slow.get()}) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(ask(*client, {{"id", 101}, {"type", "hello"}})["ok"], true);
    EXPECT_EQ(ask(*client, {{"id", 102}, {"type", "files"}})["ok"], true);
    EXPECT_LT(seconds_since(begin), 2);
  }
  const auto begin = std::chrono::steady_clock::now();
  for (const char* kind : {"phi", "albedo"})
    EXPECT_EQ(ask(*other, {{"id", 103},
                           {"type", "curves"},
                           {"kind", kind},
                           {"materials", {{{"text", "ggx_conductor"}}}}})["ok"],
              true);
  EXPECT_LT(seconds_since(begin), 4);
}

TEST_F(ExplorerWithASlowShader, ACancelledRequestEnds) {
  const auto client = page();
  const auto requests = everything_of(material_);
  for (const json& request : requests)
    client->say(request.dump());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto begin = std::chrono::steady_clock::now();
  // Long work is told twice: the first time it would give what it has.
  for (int time = 0; time < 2; ++time)
    for (const json& request : requests)
      client->say(
          json{{"id", 200 + 50 * time + int(request["id"])}, {"type", "cancel"}, {"of", request["id"]}}
              .dump());
  std::set<int> open;
  for (const json& request : requests)
    open.insert(int(request["id"]));
  while (!open.empty()) {
    const auto m = client->hear();
    ASSERT_TRUE(m) << json(open);
    const json header = decode_answer(*m).header;
    if (!header.contains("progress")) open.erase(header["id"].get<int>());
  }
  EXPECT_LT(seconds_since(begin), 2);
}

TEST_F(ExplorerWithASlowShader, AVanishedPageLeavesNoWork) {
  {
    const auto client = page();
    for (const json& request : everything_of(material_))
      client->say(request.dump());
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    client->vanish();
  }
  // Within some seconds, on however busy a machine: left alone, the work takes minutes.
  double used = 1;
  for (int tries = 0; tries < 30 && used > 0.1; ++tries) {
    const std::clock_t before = std::clock();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    used = double(std::clock() - before) / CLOCKS_PER_SEC;
  }
  EXPECT_LT(used, 0.1) << "seconds of the processor";
}

TEST(ExplorerServer, EndsAtOnceWhateverIsUnderWay) {
  ScratchFolder folder;
  std::chrono::steady_clock::time_point begin;
  {
    Explorer explorer({folder.path(), {}, 0});
    std::thread thread([&] { explorer.run(); });
    RawClient client(explorer.server().port());
    client.upgrade(explorer.server().port(), explorer.server().token());
    for (const json& request : everything_of({{"brdf", {{"name", "slow.brdf"}, {"source", slow_brdf}}}}))
      client.say(request.dump());
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    begin = std::chrono::steady_clock::now();
    explorer.stop();
    thread.join();
  }
  // One second on an idle machine; left alone, the work takes minutes.
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 10);
}

TEST_F(ExplorerNetwork, OfRequestsThatWaitInASlotTheNewestIsAnswered) {
  const auto client = page();
  std::string all;
  constexpr int count = 60;
  for (int i = 1; i <= count; ++i)
    all += RawClient::frame(json{{"id", i},
                                 {"type", "sphere"},
                                 {"slot", "s"},
                                 {"size", 256},
                                 {"material", {{"text", "ggx_conductor"}}}}
                                .dump());
  client->send(all);
  std::map<int, bool> cancelled;
  while (cancelled.size() < count) {
    const auto m = client->hear();
    ASSERT_TRUE(m);
    const json header = decode_answer(*m).header;
    cancelled[header["id"].get<int>()] = header.value("cancelled", false);
  }
  EXPECT_FALSE(cancelled[1]);
  EXPECT_FALSE(cancelled[count]);
  EXPECT_GT(std::count_if(cancelled.begin(), cancelled.end(), [](const auto& c) { return c.second; }), 0);
}

TEST(ExplorerServer, APortThatIsTakenIsAnError) {
  ScratchFolder folder;
  Explorer first({folder.path(), {}, 0});
  EXPECT_THAT(
      [&] {
        Explorer({folder.path(), {}, first.server().port()});
      },
      testing::ThrowsMessage<Error>(HasSubstr("--port 0")));
}

} // namespace
} // namespace nacre
