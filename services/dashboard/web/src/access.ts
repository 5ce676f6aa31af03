// The bearer token, where the server asks for one. Kept for this tab only.

const KEY = "wayline-token";
const TOKEN_PROTOCOL = "wayline.bearer.";
const PROTOCOL = "wayline.v1";

export function savedToken(): string | null {
  return sessionStorage.getItem(KEY);
}

export function saveToken(token: string): void {
  sessionStorage.setItem(KEY, token);
}

export function forgetToken(): void {
  sessionStorage.removeItem(KEY);
}

export function tokenHeaders(token: string | null): HeadersInit {
  return token === null ? {} : { Authorization: `Bearer ${token}` };
}

/** A browser cannot send headers with a WebSocket, so the token goes as a subprotocol. */
export function protocols(token: string | null): string[] {
  if (token === null) {
    return [PROTOCOL];
  }
  const encoded = btoa(token).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return [PROTOCOL, TOKEN_PROTOCOL + encoded];
}
