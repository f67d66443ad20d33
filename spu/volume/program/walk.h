// SPDX-License-Identifier: Apache-2.0
// Follows values through the syntax tree of one shader stage (abstract interpretation): a value is the set of
// sources that it can depend on, and a number that equal values share. Calls are followed into the functions,
// and loops until nothing new is found.
#pragma once

#include <glslang/Include/intermediate.h>

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "spu/volume/program/effects.h"
#include "spu/volume/program/operators.h"
#include "spu/volume/program/values.h"
#include "spu/volume/program/variables.h"

namespace understudy::spu::program {

/// The contents of all cells at one point of the program.
struct State {
  std::vector<Scalar> cells;
  bool reachable = true;
};

/// The location of an expression that can be assigned to.
struct Place {
  const Variable* variable = nullptr;
  std::vector<std::uint32_t> starts;  ///< several if an index decides
  std::vector<std::uint32_t> parts;   ///< offsets from each start, component by component
  FlowSets::Set index = FlowSets::empty;
  std::vector<ValueNumbers::Number> index_numbers;
  bool shared = false;  ///< all elements of the variable share its cells
};

/// The shader has no main function.
struct NoMain {};

/// Thrown for what the analysis neither follows nor can treat as unknown.
struct NotFollowed {
  std::string what;
};

class Walk {
 public:
  Walk(Stage stage, const Variables& variables);

  /// Treats a component of a uniform as this constant.
  void assume(std::string_view name, int component, double value);

  /// Follows the whole shader stage. Throws TooLarge, NoMain or NotFollowed.
  StageFacts facts(const TIntermNode& root, int version);

 private:
  class SourceList;
  using Set = FlowSets::Set;
  using Number = ValueNumbers::Number;

  /// Paths that leave a region early, joined where it ends.
  struct Exit {
    State state{.cells = {}, .reachable = false};
    Set decided_by = FlowSets::empty;
  };

  /// A loop or switch, which `break` and `continue` leave.
  struct Target {
    bool loop = false;
    Exit left;                      ///< by break, or by the loop's condition
    Exit next;                      ///< by continue
    Exit returned;                  ///< from the function, out of the loop
    Set ends_by = FlowSets::empty;  ///< what decides when the loop ends
    Set lasting = FlowSets::empty;  ///< ends_by, as far as it affects later iterations
    std::size_t number = 0;         ///< of the loop
  };

  /// Conditions that decide whether the current statement is executed.
  struct Conditions {
    Set outside = FlowSets::empty;        ///< around the calls that led here
    Set around = FlowSets::empty;         ///< in this function, around the innermost loop
    Set passed_around = FlowSets::empty;  ///< early exits passed before that loop
    Set branches = FlowSets::empty;       ///< around this statement, within the innermost loop
    Set passed = FlowSets::empty;         ///< early exits passed before this statement
  };

  struct FoundFetch {
    Fetch fetch;
    std::vector<Set> coordinate;
    std::vector<Number> exact;
    Set modifiers = FlowSets::empty;
    Set execution = FlowSets::empty;
    Number place = 0;
    std::uint32_t first_source = 0;  ///< the first of four
  };

  struct FoundLoop {
    Set condition = FlowSets::empty;
    std::optional<std::size_t> outer;
    int line = 0;
    std::uint32_t source = 0;
  };

  struct FoundDiscard {
    int line = 0;
    Set on = FlowSets::empty;
  };

  // statements.cc
  void count_step();
  void execute(const TIntermNode* node);
  void execute_branch(const glslang::TIntermBranch& branch);
  void execute_selection(const glslang::TIntermSelection& selection);
  void execute_switch(const glslang::TIntermSwitch& choice);
  void execute_discard(const glslang::TIntermBranch& branch);
  void execute_return(const glslang::TIntermBranch& branch);
  void execute_continue(const glslang::TIntermBranch& branch);
  void leave_target(const glslang::TIntermBranch& branch, Target& target);
  void end_way(Target& target);
  /// Follows both branches, or only one if the condition is known.
  void either(const Scalar& condition, const TIntermNode& at, const std::function<void()>& when_true,
              const std::function<void()>& when_false);

  // loops.cc
  void execute_loop(const glslang::TIntermLoop& loop);
  void pass_once(const glslang::TIntermLoop& loop, Target& target);
  void test_loop(const glslang::TIntermLoop& loop, Target& target);
  bool widen(const glslang::TIntermLoop& loop, const State& entry, State& head, std::uint32_t iteration);
  void taint_changed(State& state, const State& entry, Set by);
  void leave_loop(const glslang::TIntermLoop& loop, const State& entry, Target& target);
  void leave_function(const glslang::TIntermLoop& loop, const Target& target);
  std::size_t loop_number(const glslang::TIntermLoop& loop);

  // joins.cc
  /// Joins `other` into `state`; `decided_by` is what decides between the two.
  void meet(State& state, const State& other, Set decided_by, Number point);
  void add_exit(Exit& exit, const State& state, Set decided_by, Number point);
  /// Identifies a node and one of its joins within one chain of calls.
  Number point(const TIntermNode& node, std::uint32_t which);
  Set conditions();
  Set parting();
  Set conditions_in_loop();
  Set conditions_in_function();

  // expressions.cc
  Value evaluate(const glslang::TIntermTyped* node);
  std::vector<Value> evaluate_all(const glslang::TIntermSequence& arguments);
  Value evaluate_symbol(const glslang::TIntermSymbol& symbol);
  Value evaluate_constant(const glslang::TConstUnionArray& array);
  Value evaluate_binary(const glslang::TIntermBinary& binary);
  Value evaluate_unary(const glslang::TIntermUnary& unary);
  Value evaluate_aggregate(const glslang::TIntermAggregate& aggregate);
  Value evaluate_logical(const glslang::TIntermBinary& binary);
  Value evaluate_index(const glslang::TIntermBinary& binary);
  Value evaluate_assignment(const glslang::TIntermBinary& binary);
  Value evaluate_increment(const glslang::TIntermUnary& unary);
  Value evaluate_selection(const glslang::TIntermSelection& selection);
  Value evaluate_sequence(const glslang::TIntermAggregate& aggregate);
  Value unknown_value(const glslang::TType& type, const std::string& name);
  Value unknown_assignment(const glslang::TIntermBinary& binary);
  Value swizzled(const Value& base, const glslang::TIntermAggregate& components);
  Value element_of(const Value& base, std::size_t element, std::size_t cells);
  Value any_element_of(const Value& base, const Scalar& index, std::size_t cells);

  std::vector<Value> evaluate_assigned(const glslang::TIntermBinary& binary, bool with_left);

  // order.cc
  std::vector<Value> evaluate_operands(std::span<const glslang::TIntermTyped* const> operands);
  std::vector<Value> one_after_the_other(std::span<const glslang::TIntermTyped* const> operands);
  bool blend(std::vector<Scalar>& scalars, const std::vector<Scalar>& other, Number point);

  // places.cc
  std::optional<Place> place_of(const glslang::TIntermTyped* node);
  Place indexed(const glslang::TIntermBinary& binary, Place base);
  void keep_parts(Place& place, std::size_t first, std::size_t count);
  void index_by(Place& place, const Scalar& index, std::size_t cells);
  void add_choice(Place& place, const Place& other);
  Value read(const Place& place);
  void write(const Place& place, const Value& value, int line);
  void write_perhaps(const Place& place, std::uint32_t start, Scalar& cell, const Scalar& given);

  // arithmetic.cc
  Value apply(glslang::TOperator op, const glslang::TType& type, std::span<const Value> operands,
              std::span<const glslang::TType* const> types);
  Value construct(const glslang::TType& type, const glslang::TIntermSequence& arguments);
  Value construct_matrix(const glslang::TType& type, const Value& from, const glslang::TType& from_type);

  // calls.cc
  Value call(const glslang::TIntermAggregate& node);
  Value call_function(const glslang::TIntermSequence& arguments, const TIntermNode& at,
                      const Function& function);
  std::vector<std::optional<Place>> bind_parameters(const glslang::TIntermSequence& arguments,
                                                    const Function& function);
  void walk_body(const Function& function);
  void forget_locals(const Function& function);
  Value call_unknown(const glslang::TIntermAggregate& node);
  Value call_builtin(const glslang::TIntermAggregate& node);
  std::optional<Set> source_of_builtin(glslang::TOperator op);
  Value transformed_vertex();
  void emit_vertex(const TIntermNode& node);

  // fetches.cc
  Value fetch(const glslang::TIntermAggregate& node);
  void describe_fetch(FoundFetch& found, const glslang::TIntermAggregate& node,
                      const std::vector<Value>& arguments);
  FoundFetch& found_fetch(const glslang::TIntermAggregate& node, const Scalar& sampler);
  Value query_texture(const glslang::TIntermOperator& node, const std::vector<Value>& arguments);
  Value use_image(const glslang::TIntermAggregate& node);
  Value change_atomically(const glslang::TIntermOperator& node, const std::vector<Value>& arguments,
                          SideEffectKind kind, std::string name);
  Value change_buffer_atomically(const glslang::TIntermAggregate& node, const std::vector<Value>& arguments);
  /// Returns the name of a sampler or an image.
  std::string name_of(const Scalar& opaque);
  Scalar without_name(Scalar sampler) const;
  void add_side_effect(SideEffectKind kind, std::string name, int line);

  // walk.cc
  void walk_globals(const glslang::TIntermAggregate& root);
  Set own_source(SourceKind kind, const std::string& name);
  std::uint32_t add_source(Source source);

  // export.cc
  StageFacts export_facts(int version);
  std::optional<std::uint32_t> exact_source(Number number, SourceList& list);
  void export_fetches(StageFacts& facts, SourceList& list);
  void export_outputs(StageFacts& facts, SourceList& list);
  void export_inputs(StageFacts& facts);

  Stage stage_;
  const Variables& variables_;
  Effects effects_;
  Values values_;
  State state_;
  State emitted_{.cells = {}, .reachable = false};  ///< of a geometry stage
  Conditions conditions_;
  std::vector<Target*> targets_;  ///< of this function
  std::vector<Exit*> returns_;    ///< of the active calls
  std::vector<const Function*> functions_;
  std::optional<std::size_t> loop_;  ///< the innermost, in this function or its callers
  Number path_;
  std::size_t steps_ = 0;

  std::vector<Source> own_sources_;  ///< numbered after those of the variables
  std::map<std::pair<SourceKind, std::string>, std::uint32_t> own_source_by_name_;
  std::unordered_map<Number, std::size_t> fetch_by_path_;
  std::vector<FoundFetch> fetches_;
  std::unordered_map<Number, std::size_t> loop_by_path_;
  std::vector<FoundLoop> loops_;
  std::map<Number, FoundDiscard> discards_;
  std::vector<SideEffect> side_effects_;
  std::vector<std::string> not_followed_;
};

}  // namespace understudy::spu::program
