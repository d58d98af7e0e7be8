// The token, where the service wants one. It goes into a cookie that no script can read.
import { ask, onToken } from "./service.js";
import { attempt, byId } from "./elements.js";

let asking = null;

/** Asks for the token until it is good; whether there is one. */
function askForToken() {
  asking ||= new Promise((resolve) => {
    const dialog = byId("session"), input = byId("token"), wrong = byId("token-wrong");
    wrong.textContent = "";
    byId("session-form").onsubmit = async (event) => {
      event.preventDefault();
      try {
        await ask("POST", "/v1/session", { token: input.value.trim() });
        input.value = "";
        byId("leave").hidden = false;
        sessionStorage.setItem("token", "is there");
        dialog.returnValue = "good";
        dialog.close("good");
      } catch (error) {
        wrong.textContent = error.message;
        input.focus();
      }
    };
    dialog.onclose = () => {
      asking = null;
      resolve(dialog.returnValue === "good");
    };
    dialog.returnValue = "";
    dialog.showModal();
  });
  return asking;
}

/** Makes requests ask for a token, and lets the user forget it. */
export function beginSession() {
  onToken(askForToken);
  byId("session-cancel").onclick = () => byId("session").close("");
  byId("leave").hidden = !sessionStorage.getItem("token");
  byId("leave").onclick = () => attempt(async () => {
    await ask("DELETE", "/v1/session");
    sessionStorage.removeItem("token");
    location.reload();
  });
}
