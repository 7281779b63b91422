// The state that an answer of the server means: the whole of it, or how it differs from one that the page has.
// The other side of it is linecad/editing/answers.py.

/** The state of an answer to a request that told the number of `before`; what has not changed stays the same thing. */
export function stateOf(answer, before) {
  if (answer.differs_from === undefined) return answer;
  const state = { ...before, ...answer.fields, answer: answer.answer };
  for (const [name, told] of Object.entries(answer.items)) state[name] = patched(before[name], told);
  return state;
}

function patched(before, { ids, changed }) {
  const news = new Map(changed.map((item) => [item.id, item]));
  const renewed = (item, id) => (news.has(id) ? { ...item, ...news.get(id) } : item);
  if (ids === undefined) return before.map((item) => renewed(item, item.id));
  const known = new Map(before.map((item) => [item.id, item]));
  return ids.map((id) => renewed(known.get(id), id));
}

/** A new state, with the very lists of what is shown where they say the same: who draws them sees it at once. */
export function keepingWhatIsSame(state, shown) {
  if (!shown) return state;
  const lists = ["lines", "crossings", "planes", "bodies", "areas", "K", "R_cam_from_world"];
  const kept = lists.filter((name) => state[name] !== shown[name] && saysTheSame(state[name], shown[name]));
  return { ...state, ...Object.fromEntries(kept.map((name) => [name, shown[name]])) };
}

function saysTheSame(list, shown) {
  return (
    list.length === shown.length &&
    list.every((item, index) => item === shown[index] || JSON.stringify(item) === JSON.stringify(shown[index]))
  );
}
