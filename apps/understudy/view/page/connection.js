// SPDX-License-Identifier: Apache-2.0
// The connection to the program: proves knowledge of the secret, and reconnects after it is lost.

const again_ms = 1000;

// The secret follows '#', a part that browsers do not send; it survives a reload of this tab.
function secretAtHand() {
  const found = /^#secret=([0-9a-f]+)$/.exec(location.hash);
  if (found) {
    keepSecret(found[1]);
    history.replaceState(null, '', location.pathname);
  }
  return sessionStorage.getItem('secret');
}

// Another session has another volume: the settings of the last one are not for it.
function keepSecret(secret) {
  if (secret !== sessionStorage.getItem('secret')) sessionStorage.removeItem('view');
  sessionStorage.setItem('secret', secret);
}

async function proofOf(secret, challenge) {
  const bytes = text => new TextEncoder().encode(text);
  const key = await crypto.subtle.importKey('raw', bytes(secret), {name: 'HMAC', hash: 'SHA-256'}, false, ['sign']);
  const proof = new Uint8Array(await crypto.subtle.sign('HMAC', key, bytes('understudy view ' + challenge)));
  return Array.from(proof, byte => byte.toString(16).padStart(2, '0')).join('');
}

export class Connection {
  // on: {message(json), image(head, bytes), closed(), askForSecret(reason)}
  constructor(on) {
    this.on = on;
    this.socket = null;
    this.open();
  }

  open() {
    if (!window.isSecureContext) {
      this.on.askForSecret('Browsers have no cryptography for pages that come over plain http from another machine, ' +
        `so this page cannot prove that it knows the secret. Run ssh -L ${location.port}:127.0.0.1:${location.port} ${location.hostname}, and open ` +
        `http://localhost:${location.port}/ with the same #secret=… here.`);
      return;
    }
    const secret = secretAtHand();
    if (!secret) {
      this.on.askForSecret(null);
      return;
    }
    const socket = new WebSocket(location.origin.replace(/^http/, 'ws') + '/socket');
    socket.binaryType = 'arraybuffer';
    let refused = false;
    socket.onmessage = async event => {
      if (typeof event.data !== 'string') {
        const length = new DataView(event.data).getUint32(0, true);
        const head = JSON.parse(new TextDecoder().decode(new Uint8Array(event.data, 4, length)));
        this.on.image(head, new Uint8Array(event.data, 4 + length));
        return;
      }
      const message = JSON.parse(event.data);
      if (message.kind === 'challenge') {
        socket.send(JSON.stringify({proof: await proofOf(secret, message.challenge)}));
      } else if (message.kind === 'refused') {
        refused = true;
        sessionStorage.removeItem('secret');
        this.on.askForSecret(message.reason);
      } else {
        this.socket = socket;
        this.on.message(message);
      }
    };
    socket.onclose = () => {
      this.socket = null;
      if (refused) return;
      this.on.closed();
      setTimeout(() => this.open(), again_ms);
    };
  }

  useSecret(text) {
    const digits = text.trim().replace(/^.*#secret=/, '');
    keepSecret(digits);
    this.open();
  }

  send(message) {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
