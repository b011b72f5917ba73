// The pages where the ideas of the subject can be touched. The core computes; here topics are put together.
#include "explorer/desk.h"
#include "explorer/physics_topics.h"

namespace nacre {

Answer answer_physics(const Arguments& request, const Desk& desk) {
  const std::string name = request.text("topic");
  std::vector<std::string> known;
  for (const PhysicsTopic& topic : physics_topics()) {
    if (topic.name == name) {
      Answer answer = topic.answer(request, desk);
      answer.header["formula"] = topic.formula;
      answer.header["source"] = topic.source;
      return answer;
    }
    known.emplace_back(topic.name);
  }
  throw Error(fmt::format("unknown topic '{}'{}", name, suggestion(name, known)));
}

} // namespace nacre
