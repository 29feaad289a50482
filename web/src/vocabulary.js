/** The words that the service has for what its answers name. */
import { getJson } from "./service.js";

let words = {};

/**
 * Fetches the words: { methods: by the method of a detection, robot_conventions: by name, score:
 * { begin, others, sum }, each with label and meaning }.
 */
export async function fetchWords() {
  words = await getJson("/v1/words");
}

/** The words of one kind, once they are fetched. */
export const wordsOf = (kind) => words[kind] ?? {};
