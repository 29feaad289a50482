/// Routes of a session: scans, answers and truth.
#pragma once

#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"
#include "apps/service/serve/session/session.hpp"

namespace trivet::apps::service {

class SessionRoutes {
 public:
  /// responder  outlives the object, as does the session
  /// session    null: none is kept
  SessionRoutes(const Responder& responder, Session* session)
      : responder_(responder), session_(session) {}
  Routes routes() const;

 private:
  void index(const CallPtr& call, std::string_view rest) const;
  void archive(const CallPtr& call, std::string_view rest) const;
  void get_scan(const CallPtr& call, std::string_view rest) const;
  void put_scan(const CallPtr& call, std::string_view rest) const;
  void put_truth(const CallPtr& call, const std::string& name) const;
  void delete_scan(const CallPtr& call, std::string_view rest) const;
  void get_answer(const CallPtr& call, std::string_view rest) const;
  void put_answer(const CallPtr& call, std::string_view rest) const;
  void delete_run(const CallPtr& call, std::string_view rest) const;
  /// Whether a session is kept. Sends the response if none is.
  bool has_session(const CallPtr& call) const;

  const Responder& responder_;
  Session* const session_;
};

}  // namespace trivet::apps::service
