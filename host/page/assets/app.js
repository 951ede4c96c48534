/* The licences of the libraries in this file are in licences.txt beside it. */
var _x=Object.create;var Lp=Object.defineProperty;var yx=Object.getOwnPropertyDescriptor;var xx=Object.getOwnPropertyNames;var vx=Object.getPrototypeOf,Sx=Object.prototype.hasOwnProperty;var ai=(n,t)=>()=>{try{return t||n((t={exports:{}}).exports,t),t.exports}catch(e){throw t=0,e}};var bx=(n,t,e,i)=>{if(t&&typeof t=="object"||typeof t=="function")for(let s of xx(t))!Sx.call(n,s)&&s!==e&&Lp(n,s,{get:()=>t[s],enumerable:!(i=yx(t,s))||i.enumerable});return n};var Dp=(n,t,e)=>(e=n!=null?_x(vx(n)):{},bx(t||!n||!n.__esModule?Lp(e,"default",{value:n,enumerable:!0}):e,n));var rm=ai((UI,sm)=>{(()=>{var n={91:((s,r)=>{"use strict";Object.defineProperty(r,"__esModule",{value:!0}),r.buildRos2Type=B;let o=String.raw`(?<type>[a-zA-Z0-9_/]+)`,a=String.raw`(?:<=(?<stringBound>\d+))`,c=String.raw`(?:(?<unboundedArray>\[\])|\[(?<arrayLength>\d+)\]|\[<=(?<arrayBound>\d+)\])`,l=String.raw`(?<name>[a-zA-Z0-9_]+)`,h=String.raw`'(?:\\.|[^'\\])*'|"(?:\\.|[^"\\])*"`,f=String.raw`(?:${h}|(?:\\.|[^\s'"#\\])(?:\\.|[^#\\])*)`,u=String.raw`(?:${h}|(?:\\.|[^\s'"\],#\\])(?:\\.|[^\],#\\])*)`,d=String.raw`\s*=\s*(?<constantValue>${f}?)`,p=String.raw`\[(?:${u},)*${u}?\]`,_=String.raw`(?<defaultValue>${p}|${f})`,m=String.raw`(?:#.*)`,g=new RegExp(String.raw`^${o}${a}?${c}?\s+${l}(?:${d}|\s+${_})?\s*${m}?$`),v=String.raw`\\(?<char>['"abfnrtv\\])|\\(?<oct>[0-7]{1,3})|\\x(?<hex2>[a-fA-F0-9]{2})|\\u(?<hex4>[a-fA-F0-9]{4})|\\U(?<hex8>[a-fA-F0-9]{8})`,T=["bool","byte","char","float32","float64","int8","uint8","int16","uint16","int32","uint32","int64","uint64","string","wstring","time","duration","builtin_interfaces/Time","builtin_interfaces/Duration","builtin_interfaces/msg/Time","builtin_interfaces/msg/Duration"];function S(F,R,U){let X=BigInt(F);if(X<R||X>U)throw new Error(`Number ${F} out of range [${R}, ${U}]`);return X}function C(F,R,U){let X=parseInt(F);if(Number.isNaN(X))throw new Error(`Invalid numeric literal: ${F}`);if(X<R||X>U)throw new Error(`Number ${F} out of range [${R}, ${U}]`);return X}let E=new RegExp(u,"y"),y=/\s*(,)\s*|\s*$/y;function w(F,R){if(!R.startsWith("[")||!R.endsWith("]"))throw new Error("Array must start with [ and end with ]");let U=R.substring(1,R.length-1);if(F==="string"||F==="wstring"){let X=[],G=0;for(;G<U.length;){if(U[G]===",")throw new Error("Expected array element before comma");E.lastIndex=G;let ct=E.exec(U);if(ct&&(X.push(V(ct[0])),G=E.lastIndex),y.lastIndex=G,ct=y.exec(U),!ct)throw new Error("Expected comma or end of array");if(!ct[1])break;G=y.lastIndex}return X}return U.split(",").map(X=>N(F,X.trim()))}function V(F){let R="",U=F;for(let X of["'",'"'])if(F.startsWith(X)){if(!F.endsWith(X))throw new Error(`Expected terminating ${X} in string literal: ${F}`);R=X,U=F.substring(X.length,F.length-X.length);break}if(!new RegExp(String.raw`^(?:[^\\${R}]|${v})*$`).test(U)==null)throw new Error(`Invalid string literal: ${U}`);return U.replace(new RegExp(v,"g"),(...X)=>{let{char:G,oct:ct,hex2:I,hex4:k,hex8:Y}=X[X.length-1],et=I??k??Y;if(G!=null)return{"'":"'",'"':'"',a:"\x07",b:"\b",f:"\f",n:`
`,r:"\r",t:"	",v:"\v","\\":"\\"}[G];if(ct!=null)return String.fromCodePoint(parseInt(ct,8));if(et!=null)return String.fromCodePoint(parseInt(et,16));throw new Error("Expected exactly one matched group")})}function N(F,R){switch(F){case"bool":if(["true","True","1"].includes(R))return!0;if(["false","False","0"].includes(R))return!1;break;case"float32":case"float64":{let U=parseFloat(R);if(!Number.isNaN(U))return U;break}case"int8":return C(R,-128,127);case"uint8":return C(R,0,255);case"int16":return C(R,-32768,32767);case"uint16":return C(R,0,65535);case"int32":return C(R,-2147483648,2147483647);case"uint32":return C(R,0,4294967295);case"int64":return S(R,~0x7fffffffffffffffn,0x7fffffffffffffffn);case"uint64":return S(R,0n,0xffffffffffffffffn);case"string":case"wstring":return V(R)}throw new Error(`Invalid literal of type ${F}: ${R}`)}function L(F){switch(F){case"char":return"uint8";case"byte":return"uint8";case"builtin_interfaces/Time":case"builtin_interfaces/msg/Time":return"time";case"builtin_interfaces/Duration":case"builtin_interfaces/msg/Duration":return"duration"}return F}function B(F){let R=[],U;for(let{line:X}of F){let G;if(!X.startsWith("#"))if(G=/^MSG: ([^ ]+)\s*(?:#.+)?$/.exec(X)){U=G[1];continue}else if(G=g.exec(X)){let{type:ct,stringBound:I,unboundedArray:k,arrayLength:Y,arrayBound:et,name:nt,constantValue:Z,defaultValue:at}=G.groups,ut=L(ct);if(I!=null&&ut!=="string"&&ut!=="wstring")throw new Error(`Invalid string bound for type ${ut}`);if(Z!=null){if(!/^[A-Z](?:_?[A-Z0-9]+)*$/.test(nt))throw new Error(`Invalid constant name: ${nt}`)}else if(!/^[a-z](?:_?[a-z0-9]+)*$/.test(nt))throw new Error(`Invalid field name: ${nt}`);let dt=!T.includes(ut),ot=k!=null||Y!=null||et!=null;R.push({name:nt,type:ut,isComplex:Z!=null?dt||void 0:dt,isConstant:Z!=null||void 0,isArray:Z!=null?ot||void 0:ot,arrayLength:Y!=null?parseInt(Y):void 0,arrayUpperBound:et!=null?parseInt(et):void 0,upperBound:I!=null?parseInt(I):void 0,defaultValue:at!=null?ot?w(ut,at.trim()):N(ut,at.trim()):void 0,value:Z!=null?N(ut,Z.trim()):void 0,valueText:Z?.trim()})}else throw new Error(`Could not parse line: '${X}'`)}return{name:U,definitions:R}}}),155:(function(s,r,o){"use strict";var a=this&&this.__createBinding||(Object.create?(function(l,h,f,u){u===void 0&&(u=f);var d=Object.getOwnPropertyDescriptor(h,f);(!d||("get"in d?!h.__esModule:d.writable||d.configurable))&&(d={enumerable:!0,get:function(){return h[f]}}),Object.defineProperty(l,u,d)}):(function(l,h,f,u){u===void 0&&(u=f),l[u]=h[f]})),c=this&&this.__exportStar||function(l,h){for(var f in l)f!=="default"&&!Object.prototype.hasOwnProperty.call(h,f)&&a(h,l,f)};Object.defineProperty(r,"__esModule",{value:!0}),c(o(498),r),c(o(900),r)}),425:((s,r,o)=>{"use strict";Object.defineProperty(r,"__esModule",{value:!0}),r.md5=l;let a=o(479),c=new Set(["int8","uint8","int16","uint16","int32","uint32","int64","uint64","float32","float64","string","bool","char","byte","time","duration"]);function l(u){if(u.length===0)throw new Error("Cannot produce md5sum for empty msgDefs");let d=new Map;for(let _ of u)_.name!=null&&d.set(_.name,_);let p=u[0];return h(p,d)}function h(u,d){let p="",_=u.definitions.filter(({isConstant:g})=>g),m=u.definitions.filter(({isConstant:g})=>g==null||!g);for(let g of _)p+=`${g.type} ${g.name}=${g.valueText??String(g.value)}
`;for(let g of m)if(f(g.type)){let v=g.arrayLength!=null?String(g.arrayLength):"",T=g.isArray===!0?`[${v}]`:"";p+=`${g.type}${T} ${g.name}
`}else{let v=d.get(g.type);if(v==null)throw new Error(`Missing definition for submessage type "${g.type}"`);let T=h(v,d);p+=`${T} ${g.name}
`}return p=p.trimEnd(),a.Md5.init(p)}function f(u){return c.has(u)}}),479:((s,r,o)=>{"use strict";o.r(r),o.d(r,{Md5:()=>a});var a=(function(){function c(){}return c.AddUnsigned=function(l,h){var f,u,d,p,_;return d=l&2147483648,p=h&2147483648,f=l&1073741824,u=h&1073741824,_=(l&1073741823)+(h&1073741823),f&u?_^2147483648^d^p:f|u?_&1073741824?_^3221225472^d^p:_^1073741824^d^p:_^d^p},c.FF=function(l,h,f,u,d,p,_){return l=this.AddUnsigned(l,this.AddUnsigned(this.AddUnsigned(this.F(h,f,u),d),_)),this.AddUnsigned(this.RotateLeft(l,p),h)},c.GG=function(l,h,f,u,d,p,_){return l=this.AddUnsigned(l,this.AddUnsigned(this.AddUnsigned(this.G(h,f,u),d),_)),this.AddUnsigned(this.RotateLeft(l,p),h)},c.HH=function(l,h,f,u,d,p,_){return l=this.AddUnsigned(l,this.AddUnsigned(this.AddUnsigned(this.H(h,f,u),d),_)),this.AddUnsigned(this.RotateLeft(l,p),h)},c.II=function(l,h,f,u,d,p,_){return l=this.AddUnsigned(l,this.AddUnsigned(this.AddUnsigned(this.I(h,f,u),d),_)),this.AddUnsigned(this.RotateLeft(l,p),h)},c.ConvertToWordArray=function(l){for(var h,f=l.length,u=f+8,d=(u-u%64)/64,p=(d+1)*16,_=Array(p-1),m=0,g=0;g<f;)h=(g-g%4)/4,m=g%4*8,_[h]=_[h]|l.charCodeAt(g)<<m,g++;return h=(g-g%4)/4,m=g%4*8,_[h]=_[h]|128<<m,_[p-2]=f<<3,_[p-1]=f>>>29,_},c.WordToHex=function(l){var h="",f="",u,d;for(d=0;d<=3;d++)u=l>>>d*8&255,f="0"+u.toString(16),h=h+f.substr(f.length-2,2);return h},c.Utf8Encode=function(l){var h="",f;l=l.replace(/\r\n/g,`
`);for(var u=0;u<l.length;u++)f=l.charCodeAt(u),f<128?h+=String.fromCharCode(f):f>127&&f<2048?(h+=String.fromCharCode(f>>6|192),h+=String.fromCharCode(f&63|128)):(h+=String.fromCharCode(f>>12|224),h+=String.fromCharCode(f>>6&63|128),h+=String.fromCharCode(f&63|128));return h},c.init=function(l){var h;for(typeof l!="string"&&(l=JSON.stringify(l)),this._string=this.Utf8Encode(l),this.x=this.ConvertToWordArray(this._string),this.a=1732584193,this.b=4023233417,this.c=2562383102,this.d=271733878,this.k=0;this.k<this.x.length;this.k+=16)this.AA=this.a,this.BB=this.b,this.CC=this.c,this.DD=this.d,this.a=this.FF(this.a,this.b,this.c,this.d,this.x[this.k],this.S11,3614090360),this.d=this.FF(this.d,this.a,this.b,this.c,this.x[this.k+1],this.S12,3905402710),this.c=this.FF(this.c,this.d,this.a,this.b,this.x[this.k+2],this.S13,606105819),this.b=this.FF(this.b,this.c,this.d,this.a,this.x[this.k+3],this.S14,3250441966),this.a=this.FF(this.a,this.b,this.c,this.d,this.x[this.k+4],this.S11,4118548399),this.d=this.FF(this.d,this.a,this.b,this.c,this.x[this.k+5],this.S12,1200080426),this.c=this.FF(this.c,this.d,this.a,this.b,this.x[this.k+6],this.S13,2821735955),this.b=this.FF(this.b,this.c,this.d,this.a,this.x[this.k+7],this.S14,4249261313),this.a=this.FF(this.a,this.b,this.c,this.d,this.x[this.k+8],this.S11,1770035416),this.d=this.FF(this.d,this.a,this.b,this.c,this.x[this.k+9],this.S12,2336552879),this.c=this.FF(this.c,this.d,this.a,this.b,this.x[this.k+10],this.S13,4294925233),this.b=this.FF(this.b,this.c,this.d,this.a,this.x[this.k+11],this.S14,2304563134),this.a=this.FF(this.a,this.b,this.c,this.d,this.x[this.k+12],this.S11,1804603682),this.d=this.FF(this.d,this.a,this.b,this.c,this.x[this.k+13],this.S12,4254626195),this.c=this.FF(this.c,this.d,this.a,this.b,this.x[this.k+14],this.S13,2792965006),this.b=this.FF(this.b,this.c,this.d,this.a,this.x[this.k+15],this.S14,1236535329),this.a=this.GG(this.a,this.b,this.c,this.d,this.x[this.k+1],this.S21,4129170786),this.d=this.GG(this.d,this.a,this.b,this.c,this.x[this.k+6],this.S22,3225465664),this.c=this.GG(this.c,this.d,this.a,this.b,this.x[this.k+11],this.S23,643717713),this.b=this.GG(this.b,this.c,this.d,this.a,this.x[this.k],this.S24,3921069994),this.a=this.GG(this.a,this.b,this.c,this.d,this.x[this.k+5],this.S21,3593408605),this.d=this.GG(this.d,this.a,this.b,this.c,this.x[this.k+10],this.S22,38016083),this.c=this.GG(this.c,this.d,this.a,this.b,this.x[this.k+15],this.S23,3634488961),this.b=this.GG(this.b,this.c,this.d,this.a,this.x[this.k+4],this.S24,3889429448),this.a=this.GG(this.a,this.b,this.c,this.d,this.x[this.k+9],this.S21,568446438),this.d=this.GG(this.d,this.a,this.b,this.c,this.x[this.k+14],this.S22,3275163606),this.c=this.GG(this.c,this.d,this.a,this.b,this.x[this.k+3],this.S23,4107603335),this.b=this.GG(this.b,this.c,this.d,this.a,this.x[this.k+8],this.S24,1163531501),this.a=this.GG(this.a,this.b,this.c,this.d,this.x[this.k+13],this.S21,2850285829),this.d=this.GG(this.d,this.a,this.b,this.c,this.x[this.k+2],this.S22,4243563512),this.c=this.GG(this.c,this.d,this.a,this.b,this.x[this.k+7],this.S23,1735328473),this.b=this.GG(this.b,this.c,this.d,this.a,this.x[this.k+12],this.S24,2368359562),this.a=this.HH(this.a,this.b,this.c,this.d,this.x[this.k+5],this.S31,4294588738),this.d=this.HH(this.d,this.a,this.b,this.c,this.x[this.k+8],this.S32,2272392833),this.c=this.HH(this.c,this.d,this.a,this.b,this.x[this.k+11],this.S33,1839030562),this.b=this.HH(this.b,this.c,this.d,this.a,this.x[this.k+14],this.S34,4259657740),this.a=this.HH(this.a,this.b,this.c,this.d,this.x[this.k+1],this.S31,2763975236),this.d=this.HH(this.d,this.a,this.b,this.c,this.x[this.k+4],this.S32,1272893353),this.c=this.HH(this.c,this.d,this.a,this.b,this.x[this.k+7],this.S33,4139469664),this.b=this.HH(this.b,this.c,this.d,this.a,this.x[this.k+10],this.S34,3200236656),this.a=this.HH(this.a,this.b,this.c,this.d,this.x[this.k+13],this.S31,681279174),this.d=this.HH(this.d,this.a,this.b,this.c,this.x[this.k],this.S32,3936430074),this.c=this.HH(this.c,this.d,this.a,this.b,this.x[this.k+3],this.S33,3572445317),this.b=this.HH(this.b,this.c,this.d,this.a,this.x[this.k+6],this.S34,76029189),this.a=this.HH(this.a,this.b,this.c,this.d,this.x[this.k+9],this.S31,3654602809),this.d=this.HH(this.d,this.a,this.b,this.c,this.x[this.k+12],this.S32,3873151461),this.c=this.HH(this.c,this.d,this.a,this.b,this.x[this.k+15],this.S33,530742520),this.b=this.HH(this.b,this.c,this.d,this.a,this.x[this.k+2],this.S34,3299628645),this.a=this.II(this.a,this.b,this.c,this.d,this.x[this.k],this.S41,4096336452),this.d=this.II(this.d,this.a,this.b,this.c,this.x[this.k+7],this.S42,1126891415),this.c=this.II(this.c,this.d,this.a,this.b,this.x[this.k+14],this.S43,2878612391),this.b=this.II(this.b,this.c,this.d,this.a,this.x[this.k+5],this.S44,4237533241),this.a=this.II(this.a,this.b,this.c,this.d,this.x[this.k+12],this.S41,1700485571),this.d=this.II(this.d,this.a,this.b,this.c,this.x[this.k+3],this.S42,2399980690),this.c=this.II(this.c,this.d,this.a,this.b,this.x[this.k+10],this.S43,4293915773),this.b=this.II(this.b,this.c,this.d,this.a,this.x[this.k+1],this.S44,2240044497),this.a=this.II(this.a,this.b,this.c,this.d,this.x[this.k+8],this.S41,1873313359),this.d=this.II(this.d,this.a,this.b,this.c,this.x[this.k+15],this.S42,4264355552),this.c=this.II(this.c,this.d,this.a,this.b,this.x[this.k+6],this.S43,2734768916),this.b=this.II(this.b,this.c,this.d,this.a,this.x[this.k+13],this.S44,1309151649),this.a=this.II(this.a,this.b,this.c,this.d,this.x[this.k+4],this.S41,4149444226),this.d=this.II(this.d,this.a,this.b,this.c,this.x[this.k+11],this.S42,3174756917),this.c=this.II(this.c,this.d,this.a,this.b,this.x[this.k+2],this.S43,718787259),this.b=this.II(this.b,this.c,this.d,this.a,this.x[this.k+9],this.S44,3951481745),this.a=this.AddUnsigned(this.a,this.AA),this.b=this.AddUnsigned(this.b,this.BB),this.c=this.AddUnsigned(this.c,this.CC),this.d=this.AddUnsigned(this.d,this.DD);return h=this.WordToHex(this.a)+this.WordToHex(this.b)+this.WordToHex(this.c)+this.WordToHex(this.d),h.toLowerCase()},c.x=Array(),c.S11=7,c.S12=12,c.S13=17,c.S14=22,c.S21=5,c.S22=9,c.S23=14,c.S24=20,c.S31=4,c.S32=11,c.S33=16,c.S34=23,c.S41=6,c.S42=10,c.S43=15,c.S44=21,c.RotateLeft=function(l,h){return l<<h|l>>>32-h},c.F=function(l,h,f){return l&h|~l&f},c.G=function(l,h,f){return l&f|h&~f},c.H=function(l,h,f){return l^h^f},c.I=function(l,h,f){return h^(l|~f)},c})()}),498:((s,r)=>{"use strict";Object.defineProperty(r,"__esModule",{value:!0})}),662:(function(s){(function(r,o){s.exports?s.exports=o():r.nearley=o()})(this,function(){function r(d,p,_){return this.id=++r.highestId,this.name=d,this.symbols=p,this.postprocess=_,this}r.highestId=0,r.prototype.toString=function(d){var p=typeof d>"u"?this.symbols.map(u).join(" "):this.symbols.slice(0,d).map(u).join(" ")+" ● "+this.symbols.slice(d).map(u).join(" ");return this.name+" → "+p};function o(d,p,_,m){this.rule=d,this.dot=p,this.reference=_,this.data=[],this.wantedBy=m,this.isComplete=this.dot===d.symbols.length}o.prototype.toString=function(){return"{"+this.rule.toString(this.dot)+"}, from: "+(this.reference||0)},o.prototype.nextState=function(d){var p=new o(this.rule,this.dot+1,this.reference,this.wantedBy);return p.left=this,p.right=d,p.isComplete&&(p.data=p.build(),p.right=void 0),p},o.prototype.build=function(){var d=[],p=this;do d.push(p.right.data),p=p.left;while(p.left);return d.reverse(),d},o.prototype.finish=function(){this.rule.postprocess&&(this.data=this.rule.postprocess(this.data,this.reference,h.fail))};function a(d,p){this.grammar=d,this.index=p,this.states=[],this.wants={},this.scannable=[],this.completed={}}a.prototype.process=function(d){for(var p=this.states,_=this.wants,m=this.completed,g=0;g<p.length;g++){var v=p[g];if(v.isComplete){if(v.finish(),v.data!==h.fail){for(var T=v.wantedBy,S=T.length;S--;){var C=T[S];this.complete(C,v)}if(v.reference===this.index){var E=v.rule.name;(this.completed[E]=this.completed[E]||[]).push(v)}}}else{var E=v.rule.symbols[v.dot];if(typeof E!="string"){this.scannable.push(v);continue}if(_[E]){if(_[E].push(v),m.hasOwnProperty(E))for(var y=m[E],S=0;S<y.length;S++){var w=y[S];this.complete(v,w)}}else _[E]=[v],this.predict(E)}}},a.prototype.predict=function(d){for(var p=this.grammar.byName[d]||[],_=0;_<p.length;_++){var m=p[_],g=this.wants[d],v=new o(m,0,this.index,g);this.states.push(v)}},a.prototype.complete=function(d,p){var _=d.nextState(p);this.states.push(_)};function c(d,p){this.rules=d,this.start=p||this.rules[0].name;var _=this.byName={};this.rules.forEach(function(m){_.hasOwnProperty(m.name)||(_[m.name]=[]),_[m.name].push(m)})}c.fromCompiled=function(m,p){var _=m.Lexer;m.ParserStart&&(p=m.ParserStart,m=m.ParserRules);var m=m.map(function(v){return new r(v.name,v.symbols,v.postprocess)}),g=new c(m,p);return g.lexer=_,g};function l(){this.reset("")}l.prototype.reset=function(d,p){this.buffer=d,this.index=0,this.line=p?p.line:1,this.lastLineBreak=p?-p.col:0},l.prototype.next=function(){if(this.index<this.buffer.length){var d=this.buffer[this.index++];return d===`
`&&(this.line+=1,this.lastLineBreak=this.index),{value:d}}},l.prototype.save=function(){return{line:this.line,col:this.index-this.lastLineBreak}},l.prototype.formatError=function(d,p){var _=this.buffer;if(typeof _=="string"){var m=_.split(`
`).slice(Math.max(0,this.line-5),this.line),g=_.indexOf(`
`,this.index);g===-1&&(g=_.length);var v=this.index-this.lastLineBreak,T=String(this.line).length;return p+=" at line "+this.line+" col "+v+`:

`,p+=m.map(function(C,E){return S(this.line-m.length+E+1,T)+" "+C},this).join(`
`),p+=`
`+S("",T+v)+`^
`,p}else return p+" at index "+(this.index-1);function S(C,E){var y=String(C);return Array(E-y.length+1).join(" ")+y}};function h(d,p,_){if(d instanceof c)var m=d,_=p;else var m=c.fromCompiled(d,p);this.grammar=m,this.options={keepHistory:!1,lexer:m.lexer||new l};for(var g in _||{})this.options[g]=_[g];this.lexer=this.options.lexer,this.lexerState=void 0;var v=new a(m,0),T=this.table=[v];v.wants[m.start]=[],v.predict(m.start),v.process(),this.current=0}h.fail={},h.prototype.feed=function(d){var p=this.lexer;p.reset(d,this.lexerState);for(var _;;){try{if(_=p.next(),!_)break}catch(L){var T=new a(this.grammar,this.current+1);this.table.push(T);var m=new Error(this.reportLexerError(L));throw m.offset=this.current,m.token=L.token,m}var g=this.table[this.current];this.options.keepHistory||delete this.table[this.current-1];var v=this.current+1,T=new a(this.grammar,v);this.table.push(T);for(var S=_.text!==void 0?_.text:_.value,C=p.constructor===l?_.value:_,E=g.scannable,y=E.length;y--;){var w=E[y],V=w.rule.symbols[w.dot];if(V.test?V.test(C):V.type?V.type===_.type:V.literal===S){var N=w.nextState({data:C,token:_,isToken:!0,reference:v-1});T.states.push(N)}}if(T.process(),T.states.length===0){var m=new Error(this.reportError(_));throw m.offset=this.current,m.token=_,m}this.options.keepHistory&&(g.lexerState=p.save()),this.current++}return g&&(this.lexerState=p.save()),this.results=this.finish(),this},h.prototype.reportLexerError=function(d){var p,_,m=d.token;return m?(p="input "+JSON.stringify(m.text[0])+" (lexer error)",_=this.lexer.formatError(m,"Syntax error")):(p="input (lexer error)",_=d.message),this.reportErrorCommon(_,p)},h.prototype.reportError=function(d){var p=(d.type?d.type+" token: ":"")+JSON.stringify(d.value!==void 0?d.value:d),_=this.lexer.formatError(d,"Syntax error");return this.reportErrorCommon(_,p)},h.prototype.reportErrorCommon=function(d,p){var _=[];_.push(d);var m=this.table.length-2,g=this.table[m],v=g.states.filter(function(S){var C=S.rule.symbols[S.dot];return C&&typeof C!="string"});if(v.length===0)_.push("Unexpected "+p+`. I did not expect any more input. Here is the state of my parse table:
`),this.displayStateStack(g.states,_);else{_.push("Unexpected "+p+`. Instead, I was expecting to see one of the following:
`);var T=v.map(function(S){return this.buildFirstStateStack(S,[])||[S]},this);T.forEach(function(S){var C=S[0],E=C.rule.symbols[C.dot],y=this.getSymbolDisplay(E);_.push("A "+y+" based on:"),this.displayStateStack(S,_)},this)}return _.push(""),_.join(`
`)},h.prototype.displayStateStack=function(d,p){for(var _,m=0,g=0;g<d.length;g++){var v=d[g],T=v.rule.toString(v.dot);T===_?m++:(m>0&&p.push("    ^ "+m+" more lines identical to this"),m=0,p.push("    "+T)),_=T}},h.prototype.getSymbolDisplay=function(d){return f(d)},h.prototype.buildFirstStateStack=function(d,p){if(p.indexOf(d)!==-1)return null;if(d.wantedBy.length===0)return[d];var _=d.wantedBy[0],m=[d].concat(p),g=this.buildFirstStateStack(_,m);return g===null?null:[d].concat(g)},h.prototype.save=function(){var d=this.table[this.current];return d.lexerState=this.lexerState,d},h.prototype.restore=function(d){var p=d.index;this.current=p,this.table[p]=d,this.table.splice(p+1),this.lexerState=d.lexerState,this.results=this.finish()},h.prototype.rewind=function(d){if(!this.options.keepHistory)throw new Error("set option `keepHistory` to enable rewinding");this.restore(this.table[d])},h.prototype.finish=function(){var d=[],p=this.grammar.start,_=this.table[this.table.length-1];return _.states.forEach(function(m){m.rule.name===p&&m.dot===m.rule.symbols.length&&m.reference===0&&m.data!==h.fail&&d.push(m)}),d.map(function(m){return m.data})};function f(d){var p=typeof d;if(p==="string")return d;if(p==="object"){if(d.literal)return JSON.stringify(d.literal);if(d instanceof RegExp)return"character matching "+d;if(d.type)return d.type+" token";if(d.test)return"token matching "+String(d.test);throw new Error("Unknown symbol type: "+d)}}function u(d){var p=typeof d;if(p==="string")return d;if(p==="object"){if(d.literal)return JSON.stringify(d.literal);if(d instanceof RegExp)return d.toString();if(d.type)return"%"+d.type;if(d.test)return"<"+String(d.test)+">";throw new Error("Unknown symbol type: "+d)}}return{Parser:h,Grammar:c,Rule:r}})}),666:((s,r,o)=>{(function(){function a(u){return u[0]}let l=o(694).compile({space:{match:/\s+/,lineBreaks:!0},number:/-?(?:[0-9]|[1-9][0-9]+)(?:\.[0-9]+)?(?:[eE][-+]?[0-9]+)?\b/,comment:/#[^\n]*/,"[":"[","]":"]",assignment:/=[^\n]*/,fieldOrType:/[a-zA-Z_][a-zA-Z0-9_]*(?:\/[a-zA-Z][a-zA-Z0-9_]*)?/});function h(u){return u.reduce((d,p)=>({...d,...p}),{})}var f={Lexer:l,ParserRules:[{name:"main$ebnf$1",symbols:["comment"],postprocess:a},{name:"main$ebnf$1",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","boolType","arrayType","__","field","_","main$ebnf$1","simple"],postprocess:function(u){return h(u)}},{name:"main$ebnf$2",symbols:["comment"],postprocess:a},{name:"main$ebnf$2",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","bigintType","arrayType","__","field","_","main$ebnf$2","simple"],postprocess:function(u){return h(u)}},{name:"main$ebnf$3",symbols:["comment"],postprocess:a},{name:"main$ebnf$3",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","numericType","arrayType","__","field","_","main$ebnf$3","simple"],postprocess:function(u){return h(u)}},{name:"main$ebnf$4",symbols:["comment"],postprocess:a},{name:"main$ebnf$4",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","stringType","arrayType","__","field","_","main$ebnf$4","simple"],postprocess:function(u){return h(u)}},{name:"main$ebnf$5",symbols:["comment"],postprocess:a},{name:"main$ebnf$5",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","timeType","arrayType","__","field","_","main$ebnf$5","simple"],postprocess:function(u){return h(u)}},{name:"main$ebnf$6",symbols:["comment"],postprocess:a},{name:"main$ebnf$6",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","customType","arrayType","__","field","_","main$ebnf$6","complex"],postprocess:function(u){return h(u)}},{name:"main$ebnf$7",symbols:["comment"],postprocess:a},{name:"main$ebnf$7",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","boolType","__","constantField","_","boolConstantValue","_","main$ebnf$7"],postprocess:function(u){return h(u)}},{name:"main$ebnf$8",symbols:["comment"],postprocess:a},{name:"main$ebnf$8",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","bigintType","__","constantField","_","bigintConstantValue","_","main$ebnf$8"],postprocess:function(u){return h(u)}},{name:"main$ebnf$9",symbols:["comment"],postprocess:a},{name:"main$ebnf$9",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","numericType","__","constantField","_","numericConstantValue","_","main$ebnf$9"],postprocess:function(u){return h(u)}},{name:"main$ebnf$10",symbols:["comment"],postprocess:a},{name:"main$ebnf$10",symbols:[],postprocess:function(u){return null}},{name:"main",symbols:["_","stringType","__","constantField","_","stringConstantValue","_","main$ebnf$10"],postprocess:function(u){return h(u)}},{name:"main",symbols:["comment"],postprocess:function(u){return null}},{name:"main",symbols:["blankLine"],postprocess:function(u){return null}},{name:"boolType",symbols:[{literal:"bool"}],postprocess:function(u){return{type:u[0].value}}},{name:"bigintType$subexpression$1",symbols:[{literal:"int64"}]},{name:"bigintType$subexpression$1",symbols:[{literal:"uint64"}]},{name:"bigintType",symbols:["bigintType$subexpression$1"],postprocess:function(u){return{type:u[0][0].value}}},{name:"numericType$subexpression$1",symbols:[{literal:"byte"}]},{name:"numericType$subexpression$1",symbols:[{literal:"char"}]},{name:"numericType$subexpression$1",symbols:[{literal:"float32"}]},{name:"numericType$subexpression$1",symbols:[{literal:"float64"}]},{name:"numericType$subexpression$1",symbols:[{literal:"int8"}]},{name:"numericType$subexpression$1",symbols:[{literal:"uint8"}]},{name:"numericType$subexpression$1",symbols:[{literal:"int16"}]},{name:"numericType$subexpression$1",symbols:[{literal:"uint16"}]},{name:"numericType$subexpression$1",symbols:[{literal:"int32"}]},{name:"numericType$subexpression$1",symbols:[{literal:"uint32"}]},{name:"numericType",symbols:["numericType$subexpression$1"],postprocess:function(u){return{type:u[0][0].value}}},{name:"stringType",symbols:[{literal:"string"}],postprocess:function(u){return{type:u[0].value}}},{name:"timeType$subexpression$1",symbols:[{literal:"time"}]},{name:"timeType$subexpression$1",symbols:[{literal:"duration"}]},{name:"timeType",symbols:["timeType$subexpression$1"],postprocess:function(u){return{type:u[0][0].value}}},{name:"customType",symbols:[l.has("fieldOrType")?{type:"fieldOrType"}:fieldOrType],postprocess:function(u,d,p){let _=["bool","byte","char","float32","float64","int8","uint8","int16","uint16","int32","uint32","int64","uint64","string","time","duration"],m=u[0].value;return _.includes(m)?p:{type:m}}},{name:"arrayType",symbols:[{literal:"["},"_",{literal:"]"}],postprocess:function(u){return{isArray:!0}}},{name:"arrayType",symbols:[{literal:"["},"_","number","_",{literal:"]"}],postprocess:function(u){return{isArray:!0,arrayLength:u[2]}}},{name:"arrayType",symbols:["_"],postprocess:function(u){return{isArray:!1}}},{name:"field",symbols:[l.has("fieldOrType")?{type:"fieldOrType"}:fieldOrType],postprocess:function(u,d,p){let _=u[0].value;return _.match(/^[a-zA-Z][a-zA-Z0-9_]*$/)==null?p:{name:_}}},{name:"constantField",symbols:[l.has("fieldOrType")?{type:"fieldOrType"}:fieldOrType],postprocess:function(u,d,p){let _=u[0].value;return _.match(/^[a-zA-Z_][a-zA-Z0-9_]*$/)==null?p:{name:_,isConstant:!0}}},{name:"boolConstantValue",symbols:["assignment"],postprocess:function(u,d,p){let _=u[0].split("#")[0].trim();return _==="True"||_==="1"?{value:!0,valueText:_}:_==="False"||_==="0"?{value:!1,valueText:_}:p}},{name:"numericConstantValue",symbols:["assignment"],postprocess:function(u,d,p){let _=u[0].split("#")[0].trim(),m=parseFloat(_);return isNaN(m)?p:{value:m,valueText:_}}},{name:"bigintConstantValue",symbols:["assignment"],postprocess:function(u,d,p){let _=u[0].split("#")[0].trim();try{return{value:BigInt(_),valueText:_}}catch{return p}}},{name:"stringConstantValue",symbols:["assignment"],postprocess:function(u){return{value:u[0],valueText:u[0]}}},{name:"bool$subexpression$1",symbols:[{literal:"True"}]},{name:"bool$subexpression$1",symbols:[{literal:"1"}]},{name:"bool",symbols:["bool$subexpression$1"],postprocess:function(u){return!0}},{name:"bool$subexpression$2",symbols:[{literal:"False"}]},{name:"bool$subexpression$2",symbols:[{literal:"0"}]},{name:"bool",symbols:["bool$subexpression$2"],postprocess:function(u){return!1}},{name:"number",symbols:[l.has("number")?{type:"number"}:number],postprocess:function(u){return parseFloat(u[0].value)}},{name:"assignment",symbols:[l.has("assignment")?{type:"assignment"}:assignment],postprocess:function(u){return u[0].value.substr(1).trim()}},{name:"comment",symbols:[l.has("comment")?{type:"comment"}:comment],postprocess:function(u){return null}},{name:"blankLine",symbols:["_"],postprocess:function(u){return null}},{name:"_$subexpression$1",symbols:[]},{name:"_$subexpression$1",symbols:[l.has("space")?{type:"space"}:space]},{name:"_",symbols:["_$subexpression$1"],postprocess:function(u){return null}},{name:"__",symbols:[l.has("space")?{type:"space"}:space],postprocess:function(u){return null}},{name:"simple",symbols:[],postprocess:function(){return{isComplex:!1}}},{name:"complex",symbols:[],postprocess:function(){return{isComplex:!0}}}],ParserStart:"main"};typeof s.exports<"u"?s.exports=f:window.grammar=f})()}),694:(function(s,r){var o,a,c;(function(l,h){a=[],o=h,c=typeof o=="function"?o.apply(r,a):o,c!==void 0&&(s.exports=c)})(this,function(){"use strict";var l=Object.prototype.hasOwnProperty,h=Object.prototype.toString,f=typeof new RegExp().sticky=="boolean";function u(I){return I&&h.call(I)==="[object RegExp]"}function d(I){return I&&typeof I=="object"&&!u(I)&&!Array.isArray(I)}function p(I){return I.replace(/[-\/\\^$*+?.()|[\]{}]/g,"\\$&")}function _(I){var k=new RegExp("|"+I);return k.exec("").length-1}function m(I){return"("+I+")"}function g(I){if(!I.length)return"(?!)";var k=I.map(function(Y){return"(?:"+Y+")"}).join("|");return"(?:"+k+")"}function v(I){if(typeof I=="string")return"(?:"+p(I)+")";if(u(I)){if(I.ignoreCase)throw new Error("RegExp /i flag not allowed");if(I.global)throw new Error("RegExp /g flag is implied");if(I.sticky)throw new Error("RegExp /y flag is implied");if(I.multiline)throw new Error("RegExp /m flag is implied");return I.source}else throw new Error("Not a pattern: "+I)}function T(I,k){return I.length>k?I:Array(k-I.length+1).join(" ")+I}function S(I,k){for(var Y=I.length,et=0;;){var nt=I.lastIndexOf(`
`,Y-1);if(nt===-1||(et++,Y=nt,et===k)||Y===0)break}var Z=et<k?0:Y+1;return I.substring(Z).split(`
`)}function C(I){for(var k=Object.getOwnPropertyNames(I),Y=[],et=0;et<k.length;et++){var nt=k[et],Z=I[nt],at=[].concat(Z);if(nt==="include"){for(var ut=0;ut<at.length;ut++)Y.push({include:at[ut]});continue}var dt=[];at.forEach(function(ot){d(ot)?(dt.length&&Y.push(y(nt,dt)),Y.push(y(nt,ot)),dt=[]):dt.push(ot)}),dt.length&&Y.push(y(nt,dt))}return Y}function E(I){for(var k=[],Y=0;Y<I.length;Y++){var et=I[Y];if(et.include){for(var nt=[].concat(et.include),Z=0;Z<nt.length;Z++)k.push({include:nt[Z]});continue}if(!et.type)throw new Error("Rule has no type: "+JSON.stringify(et));k.push(y(et.type,et))}return k}function y(I,k){if(d(k)||(k={match:k}),k.include)throw new Error("Matching rules cannot also include states");var Y={defaultType:I,lineBreaks:!!k.error||!!k.fallback,pop:!1,next:null,push:null,error:!1,fallback:!1,value:null,type:null,shouldThrow:!1};for(var et in k)l.call(k,et)&&(Y[et]=k[et]);if(typeof Y.type=="string"&&I!==Y.type)throw new Error("Type transform cannot be a string (type '"+Y.type+"' for token '"+I+"')");var nt=Y.match;return Y.match=Array.isArray(nt)?nt:nt?[nt]:[],Y.match.sort(function(Z,at){return u(Z)&&u(at)?0:u(at)?-1:u(Z)?1:at.length-Z.length}),Y}function w(I){return Array.isArray(I)?E(I):C(I)}var V=y("error",{lineBreaks:!0,shouldThrow:!0});function N(I,k){for(var Y=null,et=Object.create(null),nt=!0,Z=null,at=[],ut=[],dt=0;dt<I.length;dt++)I[dt].fallback&&(nt=!1);for(var dt=0;dt<I.length;dt++){var ot=I[dt];if(ot.include)throw new Error("Inheritance is not allowed in stateless lexers");if(ot.error||ot.fallback){if(Y)throw!ot.fallback==!Y.fallback?new Error("Multiple "+(ot.fallback?"fallback":"error")+" rules not allowed (for token '"+ot.defaultType+"')"):new Error("fallback and error are mutually exclusive (for token '"+ot.defaultType+"')");Y=ot}var Lt=ot.match.slice();if(nt)for(;Lt.length&&typeof Lt[0]=="string"&&Lt[0].length===1;){var Zt=Lt.shift();et[Zt.charCodeAt(0)]=ot}if(ot.pop||ot.push||ot.next){if(!k)throw new Error("State-switching options are not allowed in stateless lexers (for token '"+ot.defaultType+"')");if(ot.fallback)throw new Error("State-switching options are not allowed on fallback tokens (for token '"+ot.defaultType+"')")}if(Lt.length!==0){nt=!1,at.push(ot);for(var Ut=0;Ut<Lt.length;Ut++){var ne=Lt[Ut];if(u(ne)){if(Z===null)Z=ne.unicode;else if(Z!==ne.unicode&&ot.fallback===!1)throw new Error("If one rule is /u then all must be")}}var ie=g(Lt.map(v)),$t=new RegExp(ie);if($t.test(""))throw new Error("RegExp matches empty string: "+$t);var Re=_(ie);if(Re>0)throw new Error("RegExp has capture groups: "+$t+`
Use (?: … ) instead`);if(!ot.lineBreaks&&$t.test(`
`))throw new Error("Rule should declare lineBreaks: "+$t);ut.push(m(ie))}}var be=Y&&Y.fallback,Ve=f&&!be?"ym":"gm",we=f||be?"":"|";Z===!0&&(Ve+="u");var cn=new RegExp(g(ut)+we,Ve);return{regexp:cn,groups:at,fast:et,error:Y||V}}function L(I){var k=N(w(I));return new U({start:k},"start")}function B(I,k,Y){var et=I&&(I.push||I.next);if(et&&!Y[et])throw new Error("Missing state '"+et+"' (in token '"+I.defaultType+"' of state '"+k+"')");if(I&&I.pop&&+I.pop!=1)throw new Error("pop must be 1 (in token '"+I.defaultType+"' of state '"+k+"')")}function F(I,k){var Y=I.$all?w(I.$all):[];delete I.$all;var et=Object.getOwnPropertyNames(I);k||(k=et[0]);for(var nt=Object.create(null),Z=0;Z<et.length;Z++){var at=et[Z];nt[at]=w(I[at]).concat(Y)}for(var Z=0;Z<et.length;Z++)for(var at=et[Z],ut=nt[at],dt=Object.create(null),ot=0;ot<ut.length;ot++){var Lt=ut[ot];if(Lt.include){var Zt=[ot,1];if(Lt.include!==at&&!dt[Lt.include]){dt[Lt.include]=!0;var Ut=nt[Lt.include];if(!Ut)throw new Error("Cannot include nonexistent state '"+Lt.include+"' (in state '"+at+"')");for(var ne=0;ne<Ut.length;ne++){var ie=Ut[ne];ut.indexOf(ie)===-1&&Zt.push(ie)}}ut.splice.apply(ut,Zt),ot--}}for(var $t=Object.create(null),Z=0;Z<et.length;Z++){var at=et[Z];$t[at]=N(nt[at],!0)}for(var Z=0;Z<et.length;Z++){for(var Re=et[Z],be=$t[Re],Ve=be.groups,ot=0;ot<Ve.length;ot++)B(Ve[ot],Re,$t);for(var we=Object.getOwnPropertyNames(be.fast),ot=0;ot<we.length;ot++)B(be.fast[we[ot]],Re,$t)}return new U($t,k)}function R(I){for(var k=typeof Map<"u",Y=k?new Map:Object.create(null),et=Object.getOwnPropertyNames(I),nt=0;nt<et.length;nt++){var Z=et[nt],at=I[Z],ut=Array.isArray(at)?at:[at];ut.forEach(function(dt){if(typeof dt!="string")throw new Error("keyword must be string (in keyword '"+Z+"')");k?Y.set(dt,Z):Y[dt]=Z})}return function(dt){return k?Y.get(dt):Y[dt]}}var U=function(I,k){this.startState=k,this.states=I,this.buffer="",this.stack=[],this.reset()};U.prototype.reset=function(I,k){return this.buffer=I||"",this.index=0,this.line=k?k.line:1,this.col=k?k.col:1,this.queuedToken=k?k.queuedToken:null,this.queuedText=k?k.queuedText:"",this.queuedThrow=k?k.queuedThrow:null,this.setState(k?k.state:this.startState),this.stack=k&&k.stack?k.stack.slice():[],this},U.prototype.save=function(){return{line:this.line,col:this.col,state:this.state,stack:this.stack.slice(),queuedToken:this.queuedToken,queuedText:this.queuedText,queuedThrow:this.queuedThrow}},U.prototype.setState=function(I){if(!(!I||this.state===I)){this.state=I;var k=this.states[I];this.groups=k.groups,this.error=k.error,this.re=k.regexp,this.fast=k.fast}},U.prototype.popState=function(){this.setState(this.stack.pop())},U.prototype.pushState=function(I){this.stack.push(this.state),this.setState(I)};var X=f?function(I,k){return I.exec(k)}:function(I,k){var Y=I.exec(k);return Y[0].length===0?null:Y};U.prototype._getGroup=function(I){for(var k=this.groups.length,Y=0;Y<k;Y++)if(I[Y+1]!==void 0)return this.groups[Y];throw new Error("Cannot find token type for matched text")};function G(){return this.value}if(U.prototype.next=function(){var I=this.index;if(this.queuedGroup){var k=this._token(this.queuedGroup,this.queuedText,I);return this.queuedGroup=null,this.queuedText="",k}var Y=this.buffer;if(I!==Y.length){var at=this.fast[Y.charCodeAt(I)];if(at)return this._token(at,Y.charAt(I),I);var et=this.re;et.lastIndex=I;var nt=X(et,Y),Z=this.error;if(nt==null)return this._token(Z,Y.slice(I,Y.length),I);var at=this._getGroup(nt),ut=nt[0];return Z.fallback&&nt.index!==I?(this.queuedGroup=at,this.queuedText=ut,this._token(Z,Y.slice(I,nt.index),I)):this._token(at,ut,I)}},U.prototype._token=function(I,k,Y){var et=0;if(I.lineBreaks){var nt=/\n/g,Z=1;if(k===`
`)et=1;else for(;nt.exec(k);)et++,Z=nt.lastIndex}var at={type:typeof I.type=="function"&&I.type(k)||I.defaultType,value:typeof I.value=="function"?I.value(k):k,text:k,toString:G,offset:Y,lineBreaks:et,line:this.line,col:this.col},ut=k.length;if(this.index+=ut,this.line+=et,et!==0?this.col=ut-Z+1:this.col+=ut,I.shouldThrow){var dt=new Error(this.formatError(at,"invalid syntax"));throw dt}return I.pop?this.popState():I.push?this.pushState(I.push):I.next&&this.setState(I.next),at},typeof Symbol<"u"&&Symbol.iterator){var ct=function(I){this.lexer=I};ct.prototype.next=function(){var I=this.lexer.next();return{value:I,done:!I}},ct.prototype[Symbol.iterator]=function(){return this},U.prototype[Symbol.iterator]=function(){return new ct(this)}}return U.prototype.formatError=function(I,k){if(I==null)var Y=this.buffer.slice(this.index),I={text:Y,offset:this.index,lineBreaks:Y.indexOf(`
`)===-1?0:1,line:this.line,col:this.col};var et=2,nt=Math.max(I.line-et,1),Z=I.line+et,at=String(Z).length,ut=S(this.buffer,this.line-I.line+et+1).slice(0,5),dt=[];dt.push(k+" at line "+I.line+" col "+I.col+":"),dt.push("");for(var ot=0;ot<ut.length;ot++){var Lt=ut[ot],Zt=nt+ot;dt.push(T(String(Zt),at)+"  "+Lt),Zt===I.line&&dt.push(T("",at+I.col+1)+"^")}return dt.join(`
`)},U.prototype.clone=function(){return new U(this.states,this.state)},U.prototype.has=function(I){return!0},{compile:L,states:F,error:Object.freeze({error:!0}),fallback:Object.freeze({fallback:!0}),keywords:R}})}),812:((s,r)=>{"use strict";Object.defineProperty(r,"__esModule",{value:!0}),r.stringify=o;function o(c){let l="";for(let h=0;h<c.length;h++){let f=c[h],u=f.definitions.filter(({isConstant:p})=>p),d=f.definitions.filter(({isConstant:p})=>p==null||!p);h>0&&(l+=`
================================================================================
`,l+=`MSG: ${f.name??""}
`);for(let p of u)l+=`${p.type} ${p.name} = ${p.valueText??String(p.value)}
`;if(d.length>0){l.length>0&&(l+=`
`);for(let p of d){let _=p.upperBound!=null?`<=${p.upperBound}`:"",m=p.arrayLength!=null?String(p.arrayLength):p.arrayUpperBound!=null?`<=${p.arrayUpperBound}`:"",g=p.isArray===!0?`[${m}]`:"",v=p.defaultValue!=null?` ${a(p.defaultValue)}`:"";l+=`${p.type}${_}${g} ${p.name}${v}
`}}}return l.trimEnd()}function a(c){return Array.isArray(c)?`[${c.map(l=>typeof l=="bigint"?l.toString():JSON.stringify(l)).join(", ")}]`:typeof c=="bigint"?c.toString():JSON.stringify(c)}}),881:(function(s,r,o){"use strict";var a=this&&this.__createBinding||(Object.create?(function(l,h,f,u){u===void 0&&(u=f);var d=Object.getOwnPropertyDescriptor(h,f);(!d||("get"in d?!h.__esModule:d.writable||d.configurable))&&(d={enumerable:!0,get:function(){return h[f]}}),Object.defineProperty(l,u,d)}):(function(l,h,f,u){u===void 0&&(u=f),l[u]=h[f]})),c=this&&this.__exportStar||function(l,h){for(var f in l)f!=="default"&&!Object.prototype.hasOwnProperty.call(h,f)&&a(h,l,f)};Object.defineProperty(r,"__esModule",{value:!0}),c(o(425),r),c(o(954),r),c(o(812),r)}),900:((s,r)=>{"use strict";Object.defineProperty(r,"__esModule",{value:!0}),r.isMsgDefFieldEqual=a,r.isMsgDefEqual=c;function o(l,h){if(Array.isArray(l)&&Array.isArray(h)){if(l.length!==h.length)return!1;for(let f=0;f<l.length;f++)if(l[f]!==h[f])return!1;return!0}return l===h}function a(l,h){return l.type===h.type&&l.name===h.name&&(l.isComplex??!1)===(h.isComplex??!1)&&l.enumType===h.enumType&&(l.isArray??!1)===(h.isArray??!1)&&l.arrayLength===h.arrayLength&&(l.isConstant??!1)===(h.isConstant??!1)&&l.value===h.value&&l.valueText===h.valueText&&l.upperBound===h.upperBound&&l.arrayUpperBound===h.arrayUpperBound&&(l.deprecated??!1)===(h.deprecated??!1)&&o(l.defaultValue,h.defaultValue)}function c(l,h){return(l.name==null||h.name==null||l.name===h.name)&&l.definitions.length===h.definitions.length&&l.definitions.every((f,u)=>a(f,h.definitions[u]))}}),954:(function(s,r,o){"use strict";var a=this&&this.__importDefault||function(T){return T&&T.__esModule?T:{default:T}};Object.defineProperty(r,"__esModule",{value:!0}),r.parse=d,r.fixupTypes=p,r.normalizeType=v;let c=o(155),l=o(662),h=o(91),f=a(o(666)),u=l.Grammar.fromCompiled(f.default);function d(T,S={}){let C=T.split(`
`).map(N=>N.trim()).filter(N=>N),E=[],y=[];C.forEach(N=>{N.startsWith("#")||(N.startsWith("==")?(y.push(S.ros2===!0?(0,h.buildRos2Type)(E):_(E,u)),E=[]):E.push({line:N}))}),y.push(S.ros2===!0?(0,h.buildRos2Type)(E):_(E,u));let w=[],V=y.filter(N=>w.find(L=>(0,c.isMsgDefEqual)(N,L))?!1:w.push(N));return S.skipTypeFixup!==!0&&p(V),V}function p(T){T.forEach(({definitions:S,name:C})=>{S.forEach(E=>{if(E.isComplex===!0){let y=C?.split("/").slice(0,-1).join("/"),w=g(T,E.type,y).name;if(w==null)throw new Error(`Missing type definition for ${E.type}`);E.type=w}})})}function _(T,S){let C=[],E;return T.forEach(({line:y})=>{if(y.startsWith("MSG:")){let[L,B]=m(y);E=B?.trim();return}let w=new l.Parser(S);w.feed(y);let V=w.finish();if(V.length===0)throw new Error(`Could not parse line: '${y}'`);if(V.length>1)throw new Error(`Ambiguous line: '${y}'`);let N=V[0];N!=null&&(N.type=v(N.type),C.push(N))}),{name:E,definitions:C}}function m(T){return T.replace(/#.*/gi,"").split(" ").filter(S=>S)}function g(T,S,C){let E=T.filter(y=>{let w=y.name??"";return S.length===0?w.length===0:S.includes("/")?w===S:S==="Header"?w==="std_msgs/Header":C?w===`${C}/${S}`:w.endsWith(`/${S}`)});if(E[0]==null)throw new Error(`Expected 1 top level type definition for '${S}' but found ${E.length}`);if(E.length>1)throw new Error(`Cannot unambiguously determine fully-qualified type name for '${S}'`);return E[0]}function v(T){return T==="char"?"uint8":T==="byte"?"int8":T}})},t={};function e(s){var r=t[s];if(r!==void 0)return r.exports;var o=t[s]={exports:{}};return n[s].call(o.exports,o,o.exports,e),o.exports}e.d=(s,r)=>{for(var o in r)e.o(r,o)&&!e.o(s,o)&&Object.defineProperty(s,o,{enumerable:!0,get:r[o]})},e.o=(s,r)=>Object.prototype.hasOwnProperty.call(s,r),e.r=s=>{typeof Symbol<"u"&&Symbol.toStringTag&&Object.defineProperty(s,Symbol.toStringTag,{value:"Module"}),Object.defineProperty(s,"__esModule",{value:!0})};var i=e(881);sm.exports=i})()});var Cl=ai(na=>{"use strict";Object.defineProperty(na,"__esModule",{value:!0});na.EncapsulationKind=void 0;var nv;(function(n){n[n.CDR_BE=0]="CDR_BE",n[n.CDR_LE=1]="CDR_LE",n[n.PL_CDR_BE=2]="PL_CDR_BE",n[n.PL_CDR_LE=3]="PL_CDR_LE",n[n.CDR2_BE=16]="CDR2_BE",n[n.CDR2_LE=17]="CDR2_LE",n[n.PL_CDR2_BE=18]="PL_CDR2_BE",n[n.PL_CDR2_LE=19]="PL_CDR2_LE",n[n.DELIMITED_CDR2_BE=20]="DELIMITED_CDR2_BE",n[n.DELIMITED_CDR2_LE=21]="DELIMITED_CDR2_LE",n[n.RTPS_CDR2_BE=6]="RTPS_CDR2_BE",n[n.RTPS_CDR2_LE=7]="RTPS_CDR2_LE",n[n.RTPS_DELIMITED_CDR2_BE=8]="RTPS_DELIMITED_CDR2_BE",n[n.RTPS_DELIMITED_CDR2_LE=9]="RTPS_DELIMITED_CDR2_LE",n[n.RTPS_PL_CDR2_BE=10]="RTPS_PL_CDR2_BE",n[n.RTPS_PL_CDR2_LE=11]="RTPS_PL_CDR2_LE"})(nv=na.EncapsulationKind||(na.EncapsulationKind={}))});var Xu=ai(Rl=>{"use strict";Object.defineProperty(Rl,"__esModule",{value:!0});Rl.getEncapsulationKindInfo=void 0;var vn=Cl(),iv=n=>{let t=n>vn.EncapsulationKind.PL_CDR_LE,e=n===vn.EncapsulationKind.CDR_LE||n===vn.EncapsulationKind.PL_CDR_LE||n===vn.EncapsulationKind.CDR2_LE||n===vn.EncapsulationKind.PL_CDR2_LE||n===vn.EncapsulationKind.DELIMITED_CDR2_LE||n===vn.EncapsulationKind.RTPS_CDR2_LE||n===vn.EncapsulationKind.RTPS_PL_CDR2_LE||n===vn.EncapsulationKind.RTPS_DELIMITED_CDR2_LE,i=n===vn.EncapsulationKind.DELIMITED_CDR2_BE||n===vn.EncapsulationKind.DELIMITED_CDR2_LE||n===vn.EncapsulationKind.RTPS_DELIMITED_CDR2_BE||n===vn.EncapsulationKind.RTPS_DELIMITED_CDR2_LE,s=n===vn.EncapsulationKind.PL_CDR2_BE||n===vn.EncapsulationKind.PL_CDR2_LE||n===vn.EncapsulationKind.RTPS_PL_CDR2_BE||n===vn.EncapsulationKind.RTPS_PL_CDR2_LE,r=n===vn.EncapsulationKind.PL_CDR_BE||n===vn.EncapsulationKind.PL_CDR_LE;return{isCDR2:t,littleEndian:e,usesDelimiterHeader:i||s,usesMemberHeader:s||r}};Rl.getEncapsulationKindInfo=iv});var qu=ai(Il=>{"use strict";Object.defineProperty(Il,"__esModule",{value:!0});Il.isBigEndian=void 0;var om=new Uint8Array(4),sv=new Uint32Array(om.buffer);sv[0]=1;function rv(){return om[3]===1}Il.isBigEndian=rv});var Yu=ai(qr=>{"use strict";Object.defineProperty(qr,"__esModule",{value:!0});qr.lengthCodeToObjectSizes=qr.getLengthCodeForObjectSize=void 0;function ov(n){let t;switch(n){case 1:t=0;break;case 2:t=1;break;case 4:t=2;break;case 8:t=3;break}if(t==null){if(n>4294967295)throw Error(`Object size ${n} for EMHEADER too large without specifying length code. Max size is ${4294967295}`);t=4}return t}qr.getLengthCodeForObjectSize=ov;qr.lengthCodeToObjectSizes={0:1,1:2,2:4,3:8}});var Zu=ai(Yr=>{"use strict";Object.defineProperty(Yr,"__esModule",{value:!0});Yr.SENTINEL_PID=Yr.EXTENDED_PID=void 0;Yr.EXTENDED_PID=16129;Yr.SENTINEL_PID=16130});var am=ai(Pl=>{"use strict";Object.defineProperty(Pl,"__esModule",{value:!0});Pl.CdrReader=void 0;var av=Xu(),lv=qu(),cv=Yu(),ia=Zu(),hv=new TextDecoder("utf8"),Ku=class n{constructor(t){if(this.origin=0,t.byteLength<4)throw new Error(`Invalid CDR data size ${t.byteLength}, must contain at least a 4-byte header`);this.view=new DataView(t.buffer,t.byteOffset,t.byteLength);let e=this.kind,{isCDR2:i,littleEndian:s,usesDelimiterHeader:r,usesMemberHeader:o}=(0,av.getEncapsulationKindInfo)(e);this.usesDelimiterHeader=r,this.usesMemberHeader=o,this.littleEndian=s,this.hostLittleEndian=!(0,lv.isBigEndian)(),this.isCDR2=i,this.eightByteAlignment=i?4:8,this.origin=4,this.offset=4}get kind(){return this.view.getUint8(1)}get decodedBytes(){return this.offset}get byteLength(){return this.view.byteLength}int8(){let t=this.view.getInt8(this.offset);return this.offset+=1,t}uint8(){let t=this.view.getUint8(this.offset);return this.offset+=1,t}int16(){this.align(2);let t=this.view.getInt16(this.offset,this.littleEndian);return this.offset+=2,t}uint16(){this.align(2);let t=this.view.getUint16(this.offset,this.littleEndian);return this.offset+=2,t}int32(){this.align(4);let t=this.view.getInt32(this.offset,this.littleEndian);return this.offset+=4,t}uint32(){this.align(4);let t=this.view.getUint32(this.offset,this.littleEndian);return this.offset+=4,t}int64(){this.align(this.eightByteAlignment);let t=this.view.getBigInt64(this.offset,this.littleEndian);return this.offset+=8,t}uint64(){this.align(this.eightByteAlignment);let t=this.view.getBigUint64(this.offset,this.littleEndian);return this.offset+=8,t}uint16BE(){this.align(2);let t=this.view.getUint16(this.offset,!1);return this.offset+=2,t}uint32BE(){this.align(4);let t=this.view.getUint32(this.offset,!1);return this.offset+=4,t}uint64BE(){this.align(this.eightByteAlignment);let t=this.view.getBigUint64(this.offset,!1);return this.offset+=8,t}float32(){this.align(4);let t=this.view.getFloat32(this.offset,this.littleEndian);return this.offset+=4,t}float64(){this.align(this.eightByteAlignment);let t=this.view.getFloat64(this.offset,this.littleEndian);return this.offset+=8,t}string(t){let e=t??this.uint32();if(e<=1)return this.offset+=e,"";let i=new Uint8Array(this.view.buffer,this.view.byteOffset+this.offset,e-1),s=hv.decode(i);return this.offset+=e,s}dHeader(){return this.uint32()}emHeader(){return this.isCDR2?this.memberHeaderV2():this.memberHeaderV1()}memberHeaderV1(){this.align(4);let t=this.uint16(),e=(t&16384)>>14===1,i=(t&32768)>>15===1,s=(t&16383)===ia.EXTENDED_PID;if((t&16383)===ia.SENTINEL_PID)return this.uint16(),{id:ia.SENTINEL_PID,objectSize:0,mustUnderstand:!1,readSentinelHeader:!0};if((t&16383)>ia.SENTINEL_PID||i)throw new Error(`Unsupported parameter ID header ${t.toString(16)}`);s&&this.uint16();let a=s?this.uint32():t&16383,c=s?this.uint32():this.uint16();return this.resetOrigin(),{id:a,objectSize:c,mustUnderstand:e}}resetOrigin(){this.origin=this.offset}isPresentFlag(){if(!this.isCDR2)throw new Error("isPresentFlag is only supported for CDR2");return!!this.uint8()}sentinelHeader(){return this.isCDR2?!1:(this.align(4),(this.uint16()&16383)===ia.SENTINEL_PID?(this.uint16(),!0):!1)}memberHeaderV2(){let t=this.uint32(),e=Math.abs((t&2147483648)>>31)===1,i=(t&1879048192)>>28,s=t&268435455,r=this.emHeaderObjectSize(i);return{mustUnderstand:e,id:s,objectSize:r,lengthCode:i}}emHeaderObjectSize(t){switch(t){case 0:case 1:case 2:case 3:return cv.lengthCodeToObjectSizes[t];case 4:case 5:return this.uint32();case 6:return 4*this.uint32();case 7:return 8*this.uint32();default:throw new Error(`Invalid length code ${t} in EMHEADER at offset ${this.offset-4}`)}}sequenceLength(){return this.uint32()}int8Array(t=this.sequenceLength()){let e=new Int8Array(this.view.buffer,this.view.byteOffset+this.offset,t);return this.offset+=t,e}uint8Array(t=this.sequenceLength()){let e=new Uint8Array(this.view.buffer,this.view.byteOffset+this.offset,t);return this.offset+=t,e}int16Array(t=this.sequenceLength()){return this.typedArray(Int16Array,"getInt16",t)}uint16Array(t=this.sequenceLength()){return this.typedArray(Uint16Array,"getUint16",t)}int32Array(t=this.sequenceLength()){return this.typedArray(Int32Array,"getInt32",t)}uint32Array(t=this.sequenceLength()){return this.typedArray(Uint32Array,"getUint32",t)}int64Array(t=this.sequenceLength()){return this.typedArray(BigInt64Array,"getBigInt64",t,this.eightByteAlignment)}uint64Array(t=this.sequenceLength()){return this.typedArray(BigUint64Array,"getBigUint64",t,this.eightByteAlignment)}float32Array(t=this.sequenceLength()){return this.typedArray(Float32Array,"getFloat32",t)}float64Array(t=this.sequenceLength()){return this.typedArray(Float64Array,"getFloat64",t,this.eightByteAlignment)}stringArray(t=this.sequenceLength()){let e=[];for(let i=0;i<t;i++)e.push(this.string());return e}seek(t){let e=this.offset+t;if(e<4||e>this.view.byteLength)throw new Error(`seek(${t}) failed, ${e} is outside the data range`);this.offset=e}seekTo(t){if(t<4||t>this.view.byteLength)throw new Error(`seekTo(${t}) failed, value is outside the data range`);this.offset=t}clone(){let t=new n(this.view);return t.offset=this.offset,t.origin=this.origin,t}limit(t){let e=this.offset+t;if(e<=this.view.byteLength)this.view=new DataView(this.view.buffer,this.view.byteOffset,e);else throw new RangeError(`length ${t} exceeds byte length of view`)}isAtEnd(){return this.offset>=this.view.byteLength}align(t){let e=(this.offset-this.origin)%t;e>0&&(this.offset+=t-e)}typedArray(t,e,i,s=t.BYTES_PER_ELEMENT){if(i===0)return new t;this.align(s);let r=this.view.byteOffset+this.offset;if(this.littleEndian!==this.hostLittleEndian)return this.typedArraySlow(t,e,i);if(r%t.BYTES_PER_ELEMENT===0){let o=new t(this.view.buffer,r,i);return this.offset+=t.BYTES_PER_ELEMENT*i,o}else return this.typedArrayUnaligned(t,e,i)}typedArrayUnaligned(t,e,i){if(i<10)return this.typedArraySlow(t,e,i);let s=t.BYTES_PER_ELEMENT*i,r=new Uint8Array(s);return r.set(new Uint8Array(this.view.buffer,this.view.byteOffset+this.offset,s)),this.offset+=s,new t(r.buffer,r.byteOffset,i)}typedArraySlow(t,e,i){let s=new t(i),r=this.offset;for(let o=0;o<i;o++)s[o]=this.view[e](r,this.littleEndian),r+=t.BYTES_PER_ELEMENT;return this.offset=r,s}};Pl.CdrReader=Ku});var lm=ai(Ll=>{"use strict";Object.defineProperty(Ll,"__esModule",{value:!0});Ll.CdrSizeCalculator=void 0;var Ju=class{constructor(){this.offset=4}get size(){return this.offset}int8(){return this.incrementAndReturn(1)}uint8(){return this.incrementAndReturn(1)}int16(){return this.incrementAndReturn(2)}uint16(){return this.incrementAndReturn(2)}int32(){return this.incrementAndReturn(4)}uint32(){return this.incrementAndReturn(4)}int64(){return this.incrementAndReturn(8)}uint64(){return this.incrementAndReturn(8)}float32(){return this.incrementAndReturn(4)}float64(){return this.incrementAndReturn(8)}string(t){return this.uint32(),this.offset+=t+1,this.offset}sequenceLength(){return this.uint32()}incrementAndReturn(t){let e=(this.offset-4)%t;return e>0&&(this.offset+=t-e),this.offset+=t,this.offset}};Ll.CdrSizeCalculator=Ju});var um=ai(Dl=>{"use strict";Object.defineProperty(Dl,"__esModule",{value:!0});Dl.CdrWriter=void 0;var uv=Cl(),fv=Xu(),dv=qu(),cm=Yu(),hm=Zu(),pv=new TextEncoder,sa=class n{constructor(t={}){t.buffer!=null?this.buffer=t.buffer:t.size!=null?this.buffer=new ArrayBuffer(t.size):this.buffer=new ArrayBuffer(n.DEFAULT_CAPACITY);let e=t.kind??uv.EncapsulationKind.CDR_LE,{isCDR2:i,littleEndian:s}=(0,fv.getEncapsulationKindInfo)(e);this.isCDR2=i,this.littleEndian=s,this.hostLittleEndian=!(0,dv.isBigEndian)(),this.eightByteAlignment=i?4:8,this.array=new Uint8Array(this.buffer),this.view=new DataView(this.buffer),this.resizeIfNeeded(4),this.view.setUint8(0,0),this.view.setUint8(1,e),this.view.setUint16(2,0,!1),this.offset=4,this.origin=4}get data(){return new Uint8Array(this.buffer,0,this.offset)}get size(){return this.offset}get kind(){return this.view.getUint8(1)}int8(t){return this.resizeIfNeeded(1),this.view.setInt8(this.offset,t),this.offset+=1,this}uint8(t){return this.resizeIfNeeded(1),this.view.setUint8(this.offset,t),this.offset+=1,this}int16(t){return this.align(2),this.view.setInt16(this.offset,t,this.littleEndian),this.offset+=2,this}uint16(t){return this.align(2),this.view.setUint16(this.offset,t,this.littleEndian),this.offset+=2,this}int32(t){return this.align(4),this.view.setInt32(this.offset,t,this.littleEndian),this.offset+=4,this}uint32(t){return this.align(4),this.view.setUint32(this.offset,t,this.littleEndian),this.offset+=4,this}int64(t){return this.align(this.eightByteAlignment,8),this.view.setBigInt64(this.offset,t,this.littleEndian),this.offset+=8,this}uint64(t){return this.align(this.eightByteAlignment,8),this.view.setBigUint64(this.offset,t,this.littleEndian),this.offset+=8,this}uint16BE(t){return this.align(2),this.view.setUint16(this.offset,t,!1),this.offset+=2,this}uint32BE(t){return this.align(4),this.view.setUint32(this.offset,t,!1),this.offset+=4,this}uint64BE(t){return this.align(this.eightByteAlignment,8),this.view.setBigUint64(this.offset,t,!1),this.offset+=8,this}float32(t){return this.align(4),this.view.setFloat32(this.offset,t,this.littleEndian),this.offset+=4,this}float64(t){return this.align(this.eightByteAlignment,8),this.view.setFloat64(this.offset,t,this.littleEndian),this.offset+=8,this}string(t,e=!0){let i=t.length;return e&&this.uint32(i+1),this.resizeIfNeeded(i+1),pv.encodeInto(t,new Uint8Array(this.buffer,this.offset,i)),this.view.setUint8(this.offset+i,0),this.offset+=i+1,this}dHeader(t){let e=t;return this.uint32(e),this}emHeader(t,e,i,s){return this.isCDR2?this.memberHeaderV2(t,e,i,s):this.memberHeaderV1(t,e,i)}memberHeaderV1(t,e,i){this.align(4);let s=t?16384:0;if(e>16128||i>65535){let o=s|hm.EXTENDED_PID;this.uint16(o),this.uint16(8),this.uint32(e),this.uint32(i)}else{let o=s|e;this.uint16(o);let a=i&65535;this.uint16(a)}return this.resetOrigin(),this}resetOrigin(){this.origin=this.offset}presentFlag(t){if(!this.isCDR2)throw new Error("presentFlag is only supported for CDR2");return this.uint8(t?1:0),this}sentinelHeader(){return this.isCDR2||(this.align(4),this.uint16(hm.SENTINEL_PID),this.uint16(0)),this}memberHeaderV2(t,e,i,s){if(e>268435455)throw Error(`Member ID ${e} is too large. Max value is 268435455`);let r=t?1<<31:0,o=s??(0,cm.getLengthCodeForObjectSize)(i),a=r|o<<28|e;switch(this.uint32(a),o){case 0:case 1:case 2:case 3:{let c=cm.lengthCodeToObjectSizes[o];if(i!==c)throw new Error(`Cannot write a length code ${o} header with an object size not equal to ${c}`);break}case 4:case 5:this.uint32(i);break;case 6:if(i%4!==0)throw new Error("Cannot write a length code 6 header with an object size that is not a multiple of 4");this.uint32(i>>2);break;case 7:if(i%8!==0)throw new Error("Cannot write a length code 7 header with an object size that is not a multiple of 8");this.uint32(i>>3);break;default:throw new Error(`Unexpected length code ${o}`)}return this}sequenceLength(t){return this.uint32(t)}int8Array(t,e){return e===!0&&this.sequenceLength(t.length),this.resizeIfNeeded(t.length),this.array.set(t,this.offset),this.offset+=t.length,this}uint8Array(t,e){return e===!0&&this.sequenceLength(t.length),this.resizeIfNeeded(t.length),this.array.set(t,this.offset),this.offset+=t.length,this}int16Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof Int16Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.int16(i);return this}uint16Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof Uint16Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.uint16(i);return this}int32Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof Int32Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.int32(i);return this}uint32Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof Uint32Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.uint32(i);return this}int64Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof BigInt64Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.int64(BigInt(i));return this}uint64Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof BigUint64Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.uint64(BigInt(i));return this}float32Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof Float32Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.float32(i);return this}float64Array(t,e){if(e===!0&&this.sequenceLength(t.length),t instanceof Float64Array&&this.littleEndian===this.hostLittleEndian&&t.length>=n.BUFFER_COPY_THRESHOLD)this.align(t.BYTES_PER_ELEMENT,t.byteLength),this.array.set(new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset),this.offset+=t.byteLength;else for(let i of t)this.float64(i);return this}align(t,e=t){let i=(this.offset-this.origin)%t,s=i>0?t-i:0;this.resizeIfNeeded(s+e),this.array.fill(0,this.offset,this.offset+s),this.offset+=s}resizeIfNeeded(t){let e=this.offset+t;if(this.buffer.byteLength<e){let i=this.buffer.byteLength*2,s=i>e?i:e;this.resize(s)}}resize(t){if(this.buffer.byteLength>=t)return;let e=new ArrayBuffer(t),i=new Uint8Array(e);i.set(this.array),this.buffer=e,this.array=i,this.view=new DataView(e)}};Dl.CdrWriter=sa;sa.DEFAULT_CAPACITY=16;sa.BUFFER_COPY_THRESHOLD=10});var ju=ai(ss=>{"use strict";var mv=ss&&ss.__createBinding||(Object.create?(function(n,t,e,i){i===void 0&&(i=e),Object.defineProperty(n,i,{enumerable:!0,get:function(){return t[e]}})}):(function(n,t,e,i){i===void 0&&(i=e),n[i]=t[e]})),Nl=ss&&ss.__exportStar||function(n,t){for(var e in n)e!=="default"&&!Object.prototype.hasOwnProperty.call(t,e)&&mv(t,n,e)};Object.defineProperty(ss,"__esModule",{value:!0});Nl(am(),ss);Nl(lm(),ss);Nl(um(),ss);Nl(Cl(),ss)});var tf=ai(Qu=>{"use strict";Object.defineProperty(Qu,"__esModule",{value:!0});Qu.messageDefinitionHasDataFields=gv;function gv(n){return n.some(t=>t.isConstant!==!0)}});var ym=ai(Ws=>{"use strict";var rs=Ws&&Ws.__classPrivateFieldGet||function(n,t,e,i){if(e==="a"&&!i)throw new TypeError("Private accessor was defined without a getter");if(typeof t=="function"?n!==t||!i:!t.has(n))throw new TypeError("Cannot read private member from an object whose class did not declare it");return e==="m"?i:e==="a"?i.call(n):i?i.value:t.get(n)},ra=Ws&&Ws.__classPrivateFieldSet||function(n,t,e,i,s){if(i==="m")throw new TypeError("Private method is not writable");if(i==="a"&&!s)throw new TypeError("Private accessor was defined without a setter");if(typeof t=="function"?n!==t||!s:!t.has(n))throw new TypeError("Cannot write private member to an object whose class did not declare it");return i==="a"?s.call(n,e):s?s.value=e:t.set(n,e),e},aa,Ol,Fl,oa,Ul,la,pm;Object.defineProperty(Ws,"__esModule",{value:!0});Ws.MessageReader=void 0;var _v=ju(),yv=tf(),ef=class{lastReadHadTrailingBytes(){return rs(this,Ul,"f")}lastReadByteLength(){return rs(this,oa,"f")}constructor(t,e={}){aa.add(this),Ol.set(this,void 0),Fl.set(this,void 0),oa.set(this,0),Ul.set(this,!1),la.set(this,void 0);let{timeType:i="sec,nanosec"}=e,s=t.find(r=>!xv(r));if(s==null)throw new Error("MessageReader initialized with no root MessageDefinition");ra(this,Ol,s.definitions,"f"),ra(this,Fl,new Map(t.map(r=>[r.name??"",r.definitions])),"f"),ra(this,la,i==="sec,nsec","f")}readMessage(t){let e=new _v.CdrReader(t),i=rs(this,aa,"m",pm).call(this,rs(this,Ol,"f"),e);return ra(this,oa,e.decodedBytes,"f"),ra(this,Ul,rs(this,oa,"f")<t.byteLength,"f"),i}};Ws.MessageReader=ef;Ol=new WeakMap,Fl=new WeakMap,oa=new WeakMap,Ul=new WeakMap,la=new WeakMap,aa=new WeakSet,pm=function n(t,e){let i={};if(!(0,yv.messageDefinitionHasDataFields)(t))return e.uint8(),i;for(let s of t)if(s.isConstant!==!0)if(s.isComplex===!0){let r=rs(this,Fl,"f").get(s.type);if(r==null)throw new Error(`Unrecognized complex type ${s.type}`);if(s.isArray===!0){let o=s.arrayLength??e.sequenceLength(),a=[];for(let c=0;c<o;c++)a.push(rs(this,aa,"m",n).call(this,r,e));i[s.name]=a}else i[s.name]=rs(this,aa,"m",n).call(this,r,e)}else if(s.isArray===!0){let r=(rs(this,la,"f")?Sv:gm).get(s.type);if(r==null)throw new Error(`Unrecognized primitive array type ${s.type}[]`);let o=s.arrayLength??e.sequenceLength();i[s.name]=r(e,o)}else{let r=(rs(this,la,"f")?vv:mm).get(s.type);if(r==null)throw new Error(`Unrecognized primitive type ${s.type}`);i[s.name]=r(e)}return i};function xv(n){return n.definitions.length>0&&n.definitions.every(t=>t.isConstant)}var mm=new Map([["bool",n=>!!n.int8()],["int8",n=>n.int8()],["uint8",n=>n.uint8()],["int16",n=>n.int16()],["uint16",n=>n.uint16()],["int32",n=>n.int32()],["uint32",n=>n.uint32()],["int64",n=>n.int64()],["uint64",n=>n.uint64()],["float32",n=>n.float32()],["float64",n=>n.float64()],["string",n=>n.string()],["wstring",_m],["time",n=>({sec:n.int32(),nanosec:n.uint32()})],["duration",n=>({sec:n.int32(),nanosec:n.uint32()})]]),vv=new Map([...mm,["time",n=>({sec:n.int32(),nsec:n.uint32()})],["duration",n=>({sec:n.int32(),nsec:n.uint32()})]]),gm=new Map([["bool",bv],["int8",(n,t)=>n.int8Array(t)],["uint8",(n,t)=>n.uint8Array(t)],["int16",(n,t)=>n.int16Array(t)],["uint16",(n,t)=>n.uint16Array(t)],["int32",(n,t)=>n.int32Array(t)],["uint32",(n,t)=>n.uint32Array(t)],["int64",(n,t)=>n.int64Array(t)],["uint64",(n,t)=>n.uint64Array(t)],["float32",(n,t)=>n.float32Array(t)],["float64",(n,t)=>n.float64Array(t)],["string",wv],["wstring",_m],["time",dm],["duration",dm]]),Sv=new Map([...gm,["time",fm],["duration",fm]]);function bv(n,t){let e=new Array(t);for(let i=0;i<t;i++)e[i]=!!n.int8();return e}function wv(n,t){let e=new Array(t);for(let i=0;i<t;i++)e[i]=n.string();return e}function fm(n,t){let e=new Array(t);for(let i=0;i<t;i++){let s=n.int32(),r=n.uint32();e[i]={sec:s,nsec:r}}return e}function dm(n,t){let e=new Array(t);for(let i=0;i<t;i++){let s=n.int32(),r=n.uint32();e[i]={sec:s,nanosec:r}}return e}function _m(){throw new Error("wstring is implementation-defined and therefore not supported")}});var Tm=ai($s=>{"use strict";var xm=$s&&$s.__classPrivateFieldSet||function(n,t,e,i,s){if(i==="m")throw new TypeError("Private method is not writable");if(i==="a"&&!s)throw new TypeError("Private accessor was defined without a setter");if(typeof t=="function"?n!==t||!s:!t.has(n))throw new TypeError("Cannot write private member to an object whose class did not declare it");return i==="a"?s.call(n,e):s?s.value=e:t.set(n,e),e},Pn=$s&&$s.__classPrivateFieldGet||function(n,t,e,i){if(e==="a"&&!i)throw new TypeError("Private accessor was defined without a getter");if(typeof t=="function"?n!==t||!i:!t.has(n))throw new TypeError("Cannot read private member from an object whose class did not declare it");return e==="m"?i:e==="a"?i.call(n):i?i.value:t.get(n)},Fn,ua,kl,Mm,Em,ca,Bl,vm,Sm;Object.defineProperty($s,"__esModule",{value:!0});$s.MessageWriter=void 0;var Mv=ju(),bm=tf(),Ev=new Map([["bool",1],["int8",1],["uint8",1],["int16",2],["uint16",2],["int32",4],["uint32",4],["int64",8],["uint64",8],["float32",4],["float64",8],["time",8],["duration",8]]),Av=new Map([["bool",Rv],["int8",Iv],["uint8",Am],["int16",Pv],["uint16",Lv],["int32",Dv],["uint32",Nv],["int64",Ov],["uint64",Uv],["float32",Fv],["float64",Bv],["string",kv],["time",zl],["duration",zl],["wstring",rf]]),Tv=new Map([["bool",zv],["int8",Hv],["uint8",Vv],["int16",Gv],["uint16",Wv],["int32",$v],["uint32",Xv],["int64",qv],["uint64",Yv],["float32",Zv],["float64",Kv],["string",Jv],["time",wm],["duration",wm],["wstring",rf]]);function rf(){throw new Error("wstring is implementation-defined and therefore not supported")}var sf=class{constructor(t){Fn.add(this),ua.set(this,void 0),kl.set(this,void 0);let e=t.find(i=>!Cv(i));if(e==null)throw new Error("MessageReader initialized with no root MessageDefinition");xm(this,ua,e.definitions,"f"),xm(this,kl,new Map(t.map(i=>[i.name??"",i.definitions])),"f")}calculateByteSize(t){return Pn(this,Fn,"m",Mm).call(this,Pn(this,ua,"f"),t,4)}writeMessage(t,e){let i=new Mv.CdrWriter({buffer:e,size:e?void 0:this.calculateByteSize(t)});return Pn(this,Fn,"m",Em).call(this,Pn(this,ua,"f"),t,i),i.data}};$s.MessageWriter=sf;ua=new WeakMap,kl=new WeakMap,Fn=new WeakSet,Mm=function n(t,e,i){let s=e,r=i;if(!(0,bm.messageDefinitionHasDataFields)(t))return i+Pn(this,Fn,"m",Bl).call(this,"uint8");for(let o of t){if(o.isConstant===!0)continue;let a=s?.[o.name];if(o.isArray===!0){let c=o.arrayLength??nf(a),h=Array.isArray(a)||ArrayBuffer.isView(a)?a:[];if(o.arrayLength==null&&(r+=ha(r,4),r+=4),o.isComplex===!0){let f=Pn(this,Fn,"m",ca).call(this,o.type);for(let u=0;u<c;u++){let d=h[u]??{};r=Pn(this,Fn,"m",n).call(this,f,d,r)}}else if(o.type==="string")for(let f=0;f<c;f++){let u=h[f]??"";r+=ha(r,4),r+=4+u.length+1}else{let f=Pn(this,Fn,"m",Bl).call(this,o.type),u=o.type==="time"||o.type==="duration"?4:f;r+=ha(r,u),r+=f*c}}else if(o.isComplex===!0){let c=Pn(this,Fn,"m",ca).call(this,o.type),l=a??{};r=Pn(this,Fn,"m",n).call(this,c,l,r)}else if(o.type==="string"){let c=typeof a=="string"?a:"";r+=ha(r,4),r+=4+c.length+1}else{let c=Pn(this,Fn,"m",Bl).call(this,o.type),l=o.type==="time"||o.type==="duration"?4:c;r+=ha(r,l),r+=c}}return r},Em=function n(t,e,i){let s=e;if(!(0,bm.messageDefinitionHasDataFields)(t)){Am(0,0,i);return}for(let r of t){if(r.isConstant===!0)continue;let o=s?.[r.name];if(r.isArray===!0){let a=r.arrayLength??nf(o),l=Array.isArray(o)||ArrayBuffer.isView(o)?o:[];if(r.arrayLength==null&&i.sequenceLength(a),r.arrayLength!=null&&o!=null){let h=nf(o);if(h!==r.arrayLength)throw new Error(`Expected ${r.arrayLength} items for fixed-length array field ${r.name} but received ${h}`)}if(r.isComplex===!0){let h=Pn(this,Fn,"m",ca).call(this,r.type);for(let f=0;f<a;f++){let u=l[f]??{};Pn(this,Fn,"m",n).call(this,h,u,i)}}else Pn(this,Fn,"m",Sm).call(this,r.type)(o,r.defaultValue,i,r.arrayLength)}else if(r.isComplex===!0){let a=Pn(this,Fn,"m",ca).call(this,r.type),c=o??{};Pn(this,Fn,"m",n).call(this,a,c,i)}else Pn(this,Fn,"m",vm).call(this,r.type)(o,r.defaultValue,i)}},ca=function(t){let e=Pn(this,kl,"f").get(t);if(e==null)throw new Error(`Unrecognized complex type ${t}`);return e},Bl=function(t){let e=Ev.get(t);if(e==null)throw t==="wstring"&&rf(),new Error(`Unrecognized primitive type ${t}`);return e},vm=function(t){let e=Av.get(t);if(e==null)throw new Error(`Unrecognized primitive type ${t}`);return e},Sm=function(t){let e=Tv.get(t);if(e==null)throw new Error(`Unrecognized primitive type ${t}[]`);return e};function Cv(n){return n.definitions.length>0&&n.definitions.every(t=>t.isConstant)}function nf(n){let t=n?.length;return typeof t=="number"?t:0}function Rv(n,t,e){let i=typeof n=="boolean"?n:t??!1;e.int8(i?1:0)}function Iv(n,t,e){e.int8(typeof n=="number"?n:t??0)}function Am(n,t,e){e.uint8(typeof n=="number"?n:t??0)}function Pv(n,t,e){e.int16(typeof n=="number"?n:t??0)}function Lv(n,t,e){e.uint16(typeof n=="number"?n:t??0)}function Dv(n,t,e){e.int32(typeof n=="number"?n:t??0)}function Nv(n,t,e){e.uint32(typeof n=="number"?n:t??0)}function Ov(n,t,e){typeof n=="bigint"?e.int64(n):typeof n=="number"?e.int64(BigInt(n)):e.int64(t??0n)}function Uv(n,t,e){typeof n=="bigint"?e.uint64(n):typeof n=="number"?e.uint64(BigInt(n)):e.uint64(t??0n)}function Fv(n,t,e){e.float32(typeof n=="number"?n:t??0)}function Bv(n,t,e){e.float64(typeof n=="number"?n:t??0)}function kv(n,t,e){e.string(typeof n=="string"?n:t??"")}function zl(n,t,e){if(n==null){e.int32(0),e.uint32(0);return}let i=n;e.int32(i.sec??0),e.uint32(i.nsec??i.nanosec??0)}function zv(n,t,e,i){if(Array.isArray(n)){let s=new Int8Array(n);e.int8Array(s)}else e.int8Array(t??new Int8Array(i??0).fill(0))}function Hv(n,t,e,i){if(n instanceof Int8Array)e.int8Array(n);else if(Array.isArray(n)){let s=new Int8Array(n);e.int8Array(s)}else e.int8Array(t??new Int8Array(i??0).fill(0))}function Vv(n,t,e,i){if(n instanceof Uint8Array)e.uint8Array(n);else if(n instanceof Uint8ClampedArray)e.uint8Array(new Uint8Array(n));else if(Array.isArray(n)){let s=new Uint8Array(n);e.uint8Array(s)}else e.uint8Array(t??new Uint8Array(i??0).fill(0))}function Gv(n,t,e,i){if(n instanceof Int16Array)e.int16Array(n);else if(Array.isArray(n)){let s=new Int16Array(n);e.int16Array(s)}else e.int16Array(t??new Int16Array(i??0).fill(0))}function Wv(n,t,e,i){if(n instanceof Uint16Array)e.uint16Array(n);else if(Array.isArray(n)){let s=new Uint16Array(n);e.uint16Array(s)}else e.uint16Array(t??new Uint16Array(i??0).fill(0))}function $v(n,t,e,i){if(n instanceof Int32Array)e.int32Array(n);else if(Array.isArray(n)){let s=new Int32Array(n);e.int32Array(s)}else e.int32Array(t??new Int32Array(i??0).fill(0))}function Xv(n,t,e,i){if(n instanceof Uint32Array)e.uint32Array(n);else if(Array.isArray(n)){let s=new Uint32Array(n);e.uint32Array(s)}else e.uint32Array(t??new Uint32Array(i??0).fill(0))}function qv(n,t,e,i){if(n instanceof BigInt64Array)e.int64Array(n);else if(Array.isArray(n)){let s=new BigInt64Array(n);e.int64Array(s)}else e.int64Array(t??new BigInt64Array(i??0).fill(0n))}function Yv(n,t,e,i){if(n instanceof BigUint64Array)e.uint64Array(n);else if(Array.isArray(n)){let s=new BigUint64Array(n);e.uint64Array(s)}else e.uint64Array(t??new BigUint64Array(i??0).fill(0n))}function Zv(n,t,e,i){if(n instanceof Float32Array)e.float32Array(n);else if(Array.isArray(n)){let s=new Float32Array(n);e.float32Array(s)}else e.float32Array(t??new Float32Array(i??0).fill(0))}function Kv(n,t,e,i){if(n instanceof Float64Array)e.float64Array(n);else if(Array.isArray(n)){let s=new Float64Array(n);e.float64Array(s)}else e.float64Array(t??new Float64Array(i??0).fill(0))}function Jv(n,t,e,i){if(Array.isArray(n))for(let s of n)e.string(typeof s=="string"?s:"");else{let s=t??new Array(i??0).fill("");for(let r of s)e.string(r)}}function wm(n,t,e,i){if(Array.isArray(n))for(let s of n)zl(s,void 0,e);else{let s=new Array(i).fill(void 0);for(let r of s)zl(r,void 0,e)}}function ha(n,t){let e=(n-4)%t;return e>0?t-e:0}});var Rm=ai(Xs=>{"use strict";var jv=Xs&&Xs.__createBinding||(Object.create?(function(n,t,e,i){i===void 0&&(i=e);var s=Object.getOwnPropertyDescriptor(t,e);(!s||("get"in s?!t.__esModule:s.writable||s.configurable))&&(s={enumerable:!0,get:function(){return t[e]}}),Object.defineProperty(n,i,s)}):(function(n,t,e,i){i===void 0&&(i=e),n[i]=t[e]})),Cm=Xs&&Xs.__exportStar||function(n,t){for(var e in n)e!=="default"&&!Object.prototype.hasOwnProperty.call(t,e)&&jv(t,n,e)};Object.defineProperty(Xs,"__esModule",{value:!0});Cm(ym(),Xs);Cm(Tm(),Xs)});function J(n){return document.getElementById(n)}function qt(n,t={},...e){let i=document.createElement(n);for(let[s,r]of Object.entries(t))s.includes("-")||s==="role"||s==="for"?i.setAttribute(s,r):i[s]=r;return i.append(...e.map(s=>s instanceof Node?s:document.createTextNode(String(s)))),i}function li(n,t={},...e){let i=document.createElementNS("http://www.w3.org/2000/svg",n);for(let[s,r]of Object.entries(t))i.setAttribute(s,r);return i.append(...e),i}function Bt(n,t){n.textContent!==t&&(n.textContent=t)}function Gn(n,t,e,i){for(;n.children.length>t.length;)n.lastElementChild.remove();for(;n.children.length<t.length;)n.append(e());t.forEach((s,r)=>i(n.children[r],s,r))}function Qe(n,t=3){if(!Number.isFinite(n))return"–";if(n===0)return"0";let e=Math.abs(n);return e>=10**t?Math.round(n).toString():e<1e-4?n.toExponential(1):n.toFixed(Math.max(0,t-1-Math.floor(Math.log10(e))))}function Vs(n,t,e=3){return Number.isFinite(n)?`${Qe(n,e)} ${t}`:"–"}function Qo(n){return n===1/0?"above range":Number.isFinite(n)?n>=1e6?`${Qe(n/1e6)} MΩ`:n>=1e3?`${Qe(n/1e3)} kΩ`:`${Qe(n)} Ω`:"–"}function xl(n){let t=Number(n);if(t<1e3)return`${t} B`;let[e,i]=t<1e6?[1e3,"kB"]:t<1e9?[1e6,"MB"]:[1e9,"GB"];return`${(t/e).toFixed(1)} ${i}`}function vl(n){let t=Math.max(0,Math.round(n*1e3)),e=(o,a)=>String(o).padStart(a,"0"),i=Math.floor(t/36e5),s=Math.floor(t/6e4)%60,r=`${e(Math.floor(t/1e3)%60,2)}.${e(t%1e3,3)}`;return i>0?`${i}:${e(s,2)}:${r}`:`${s}:${r}`}function Np(n){let t=Sl(n);return Number.isFinite(n.force)?`${t} ${Vs(n.pressure/1e3,"kPa")} ${bl(n.force)}`:`${t} strength ${Gs(n.strength)}`}function Op({force:n,strength:t}){return Number.isFinite(n)?bl(n):Gs(t)}function Gs(n){return Number.isFinite(n)?n.toFixed(3):"–"}function Sl(n){return n.is_tracked?`#${n.id}`:"new"}function bl(n){return Number.isFinite(n)?`${n.toFixed(n<10?2:1)} N`:"–"}var Wr={no_board:{word:"No board",level:"bad"},no_patch:{word:"No patch",level:"bad"},not_tared:{word:"Not tared",level:"warn"},taring:{word:"Taring",level:"warn"},live:{word:"Live",level:"good"},lost:{word:"Lost",level:"bad"},ended:{word:"Ended",level:"warn"}};function Up(n){let t=J("said-actions"),e=(r,o,a)=>(r.setAttribute("aria-busy","true"),n.call(o,a).then(()=>Bt(t,""),c=>{t.dataset.kind="error",Bt(t,c.message)}).finally(()=>r.removeAttribute("aria-busy"))),i=()=>e(J("tare"),"/dermatome/tare",{}),s=()=>e(J("record"),"/dermatome/record",{start:!n.liveStatus?.recording});return J("tare").addEventListener("click",i),J("record").addEventListener("click",s),n.listen(r=>{["status","liveStatus","program","player","new"].some(o=>r.has(o))&&wx(n)}),{tare:i,record:s}}function wx(n){let t=n.liveStatus,e=!!t?.recording&&n.program.isOpen;J("tare").disabled=!n.offers("/dermatome/tare"),J("record").disabled=!n.offers("/dermatome/record"),J("record").setAttribute("aria-pressed",String(e)),Bt(J("record-word"),e?"Stop":"Record");let i=J("recording-line");i.hidden=!e,e&&Bt(i,`Recording to ${t.recording}: ${xl(t.recorded_bytes)}, ${t.recorded_frames} frames`)}var Mx=500,Ex=3,Bp=3,Fp=1e4;function kp(n){let t=[],e=()=>Ix(n,t,i),i=s=>{t.splice(s,1),e()};J("reading-form").addEventListener("submit",s=>{s.preventDefault(),Ax(n).then(r=>{t.push(r),Bt(J("said-reading"),""),e()},r=>Bt(J("said-reading"),r.message))}),J("calibrate").addEventListener("click",()=>Rx(n,t)),n.listen(s=>{(s.has("contacts")||s.has("new"))&&Dx(n.shown.contacts),(s.has("skin")||s.has("new"))&&Nx(n.shown.skin),(s.has("program")||s.has("player"))&&e()}),e()}async function Ax(n){let t=J("pressure").value.trim()===""?NaN:Number(J("pressure").value);if(!(t>0&&t<=Fp))throw new Error(`Type the pressure first: a number above 0, up to ${Fp} kPa.`);if(n.player)throw new Error("A recording is shown. Close it to take readings of the skin.");let e=J("take-reading");e.disabled=!0,Bt(J("said-reading"),"Reading. Keep the pressure steady.");let i=await Tx(n,Mx).finally(()=>e.disabled=!1);return{pressure:t,...Cx(i)}}function Tx(n,t){let e=[],i=n.listen(s=>{let r=n.shown.contacts?.contacts[0];s.has("contacts")&&r&&e.push(r.strength)});return new Promise(s=>setTimeout(s,t,e)).finally(i)}function Cx(n){let t=n.filter(Number.isFinite);if(t.length<Ex)throw new Error("No contact was seen in that half second. Press on the skin, hold it, and take the reading again.");let e=t.reduce((s,r)=>s+r,0)/t.length,i=t.reduce((s,r)=>s+(r-e)**2,0)/(t.length-1);return{strength:e,spread:Math.sqrt(i)}}async function Rx(n,t){let e=J("said-calibrate"),i=J("calibrate");i.disabled=!0,Bt(e,"Fitting."),e.dataset.kind="progress";try{let s={readings:t.map(({pressure:a,strength:c})=>({pressure_kpa:a,strength:c}))},{text:r="Calibrated.",file:o}=await n.call("/dermatome/calibrate",s);e.dataset.kind="good",Bt(e,o?`${r} Written to ${o}.`:r)}catch(s){e.dataset.kind="error",Bt(e,s.message)}i.disabled=!zp(n,t)}function zp(n,t){return Hp(t)>=Bp&&n.offers("/dermatome/calibrate")}function Hp(n){return new Set(n.map(({pressure:t})=>t)).size}function Ix(n,t,e){Gn(J("readings"),t,Px,(i,{pressure:s,strength:r,spread:o},a)=>{[Vs(s,"kPa",4),Gs(r),`± ${Qe(o,2)}`].forEach((h,f)=>Bt(i.children[f],h));let l=i.lastChild.firstChild;l.setAttribute("aria-label",`Remove the reading at ${s} kPa`),l.onclick=()=>e(a)}),J("calibrate").disabled=!zp(n,t),Bt(J("calibrate-hint"),Lx(n,t))}function Px(){let n=qt("button",{type:"button",className:"small"},"Remove");return qt("tr",{},qt("td"),qt("td"),qt("td"),qt("td",{},n))}function Lx(n,t){let e=Bp-Hp(t);return e>0?`${e} more, each at another pressure.`:n.offers("/dermatome/calibrate")?"":"The program does not offer to calibrate now."}function Dx(n){let t=n?.contacts[0];Bt(J("strongest"),t?`Strongest contact now: ${Gs(t.strength)}`:"No contact now.")}function Nx(n){let t=n?.is_calibrated?"The patch in use is calibrated: contacts have kPa and N.":"The patch in use is not calibrated: contacts have a strength, but no kPa.";Bt(J("calibrated"),n?t:"No skin is known yet.")}var Ox=["#440154","#472d7b","#3b528b","#2c728e","#21918c","#28ae80","#5ec962","#addc30","#fde725"],Ux=["#00224e","#213d6b","#4d556b","#6c6e72","#8e8978","#b8a769","#e1cc55","#fee838"];var gr={viridis:{title:"Viridis",points:Ox.map(Vp),isDiverging:!1},cividis:{title:"Cividis",points:Ux.map(Vp),isDiverging:!1},diverging:{title:"Blue–red, zero in the middle",points:Fx(),isDiverging:!0}};function Fx(){let n=t=>[1,.75,.5,.25].map(e=>Bx(e,t));return[...n(255),[.97,0,0],...n(40).reverse()]}function Bx(n,t){let e=.145*Math.sin(Math.PI*Math.min(1,.25+n*.5)),i=t*Math.PI/180;return[.97-.62*n,e*n**.5*Math.cos(i),e*n**.5*Math.sin(i)]}function ta(n,t){let{points:e}=gr[n],i=Math.min(1,Math.max(0,t))*(e.length-1),s=Math.min(e.length-2,Math.floor(i)),r=i-s;return kx(e[s].map((o,a)=>o+(e[s+1][a]-o)*r))}function Gp(n){let t=new Uint8Array(1024);for(let e=0;e<256;e++)t.set([...ta(n,e/255),255],e*4);return t}function wl([n,t,e]){return`rgb(${n}, ${t}, ${e})`}function Wp(n,t="to top"){let e=Array.from({length:17},(i,s)=>wl(ta(n,s/16)));return`linear-gradient(${t}, ${e.join(", ")})`}function Vp(n){let[t,e,i]=[1,3,5].map(a=>zx(parseInt(n.slice(a,a+2),16)/255)),s=Math.cbrt(.4122214708*t+.5363325363*e+.0514459929*i),r=Math.cbrt(.2119034982*t+.6806995451*e+.1073969566*i),o=Math.cbrt(.0883024619*t+.2817188376*e+.6299787005*i);return[.2104542553*s+.793617785*r-.0040720468*o,1.9779984951*s-2.428592205*r+.4505937099*o,.0259040371*s+.7827717662*r-.808675766*o]}function kx([n,t,e]){let i=(n+.3963377774*t+.2158037573*e)**3,s=(n-.1055613458*t-.0638541728*e)**3,r=(n-.0894841775*t-1.291485548*e)**3;return[4.0767416621*i-3.3077115913*s+.2309699292*r,-1.2684380046*i+2.6097574011*s-.3413193965*r,-.0041960863*i-.7034186147*s+1.707614701*r].map(o=>Math.round(255*Math.min(1,Math.max(0,Hx(o)))))}function zx(n){return n<=.04045?n/12.92:((n+.055)/1.055)**2.4}function Hx(n){return n<=.0031308?12.92*n:1.055*Math.max(0,n)**(1/2.4)-.055}var Vx=["force","strength","count"],$r=class{constructor(t){this.span=t,this.bySpace=new Map}get spaces(){return[...this.bySpace.keys()].sort()}get all(){return this.spaces.map(t=>this.bySpace.get(t))}take(t,e,i,s){this.bySpace.has(t)||this.bySpace.set(t,new zu(this.span)),this.bySpace.get(t).take(e,i,s)}},zu=class{constructor(t=60){this.span=t,this.clear()}clear(){this.series=new Map,this.lostBefore=void 0}of(t){return this.series.has(t)||this.series.set(t,{times:[],values:[]}),this.series.get(t)}take(t,e,i){t==="contacts"?this.addContacts(e,i.contacts):this.addStatus(e,i)}addContacts(t,e){this.add("force",t,Hu(e)),this.add("strength",t,Vu(e)),this.add("count",t,e.length)}addStatus(t,e){let i=Number(e.frames_lost);if(this.add("rate",t,e.frames_per_second),this.add("noise",t,e.signal_to_noise),this.add("lost",t,this.lostRate(t,i)),this.lostBefore={time:t,lost:i},e.state!=="live")for(let s of Vx)this.end(s,t)}end(t,e){let i=this.of(t),s=i.times.length-1;s>=0&&i.values[s]!==null&&this.begin(i,Math.max(e,i.times[s]+.05),NaN)}lostRate(t,e){let i=this.lostBefore;return!i||t<=i.time||e<i.lost?0:(e-i.lost)/(t-i.time)}add(t,e,i){let s=this.of(t),r=s.times.length-1;if(r>=0&&e<s.times[r]-.05)s.times.length=s.values.length=0;else if(r>=0&&e-s.times[r]<.05)return Gx(s,r,i);this.begin(s,e,i)}begin(t,e,i){t.times.push(e),t.values.push(Number.isFinite(i)?i:null),Wx(t,e-this.span)}before(t,e){let{times:i,values:s}=this.of(t),[r,o]=[$p(i,e-60),$p(i,e)];return{times:i.slice(r,o),values:s.slice(r,o)}}};function Xp(n,t){let[e,i]=[Math.floor((t-60)/.05),Math.floor(t/.05)],s=Array.from({length:i-e+1},(o,a)=>(e+a)*.05-t),r=n.map(({times:o,values:a})=>{let c=Array(s.length);return o.forEach((l,h)=>{let f=Math.floor(l/.05)-e;f>=0&&f<c.length&&(c[f]=a[h])}),c});return[s,...r]}function Hu(n){return n.reduce((t,{force:e})=>t+e,0)}function Vu(n){return n.reduce((t,{strength:e})=>t+e,0)}function Gx({values:n},t,e){let i=n[t];Number.isFinite(e)&&(i===null||Math.abs(e)>Math.abs(i))&&(n[t]=e)}function Wx({times:n,values:t},e){let i=n.findIndex(s=>s>=e);i<=0||(n.splice(0,i),t.splice(0,i))}function $p(n,t){let[e,i]=[0,n.length];for(;e<i;){let s=e+i>>1;n[s]>t?i=s:e=s+1}return e}var qp="/dermatome/",Ml="dermatome",Yp=["/links","/tf","/tf_static"],$x=["/skin","/image","/contacts","/status"];function ea(n){return n.slice(n.indexOf("/")+1)}function El(n){return n.slice(n.indexOf("/")+1,n.lastIndexOf("/"))}function Gu(n){return n.some(({topic:t})=>t===Yp[0])}function Zp(n,t){let e=`/${t}/`;return n.startsWith(e)?qp+n.slice(e.length):void 0}function Wu({id:n,topic:t},e,i){return e!=="*"?Zp(t,e):i.some(r=>$x.some(o=>t===`/${r}${o}`))||Yp.includes(t)?`${n}${t}`:void 0}var Xx=100;function Kp(n){let t=!1,e=0,i=r=>{if(!t)return;["status","skin","new"].some(a=>r.has(a))&&Jx(n);let o=performance.now()-e>Xx;!r.has("new")&&!(o&&["contacts","status","robot"].some(a=>r.has(a)))||(e=performance.now(),n.isWhole?Yx(n.robot):qx(n.shown))};return n.listen(i),{setSeen:r=>{t=r,i(new Set(["new"]))}}}function qx({contacts:n,skin:t,status:e}){let i=(n?.contacts??[]).slice().sort((r,o)=>r.id-o.id),s=t?.is_calibrated??!1;Xr(J("figures"),[["Contacts",n?i.length:"–"],s?["Force",bl(Hu(i))]:["Strength",n?Gs(Vu(i)):"–"],["Frames/s",Qe(e?.frames_per_second??NaN)],["Signal/noise",Vs(e?.signal_to_noise??NaN,"dB",2)]]),J("no-contacts").hidden=i.length>0,Bt(J("no-contacts"),n?"Nothing touches the skin.":"No contacts are known."),Gn(J("contact-rows"),i,Jp,jp)}function Yx({contacts:n,skins:t}){let e=n.sort((r,o)=>r.space.localeCompare(o.space)||r.id-o.id),i=[...t.values()].map(({status:r})=>r?.frames_per_second).filter(Number.isFinite),s=[...t.values()].filter(({contacts:r})=>r).length;Xr(J("figures"),[["Contacts",s>0?e.length:"–"],["Skins",t.size],["Least frames/s",i.length>0?Qe(Math.min(...i)):"–"]]),J("no-contacts").hidden=e.length>0,Bt(J("no-contacts"),Zx(s,t.size)),Gn(J("contact-rows"),e,Jp,jp),Xr(J("session"),[...t].map(([r,{status:o,contacts:a}])=>[ea(r),Kx(o,a)]))}function Zx(n,t){return n===0?"No contacts are known.":n<t?"Nothing touches the skins that tell contacts.":"Nothing touches the robot."}function Kx(n,t){let e=t?.contacts.length,i=t&&`${e} ${e===1?"contact":"contacts"}`;return[Wr[n?.state]?.word??"–",i,n?.text].filter(Boolean).join(", ")}function Jp(){return qt("tr",{},qt("th",{scope:"row"}),...Array.from({length:5},()=>qt("td")))}function jp(n,t){let{area:e,strength:i,pressure:s,force:r,space:o}=t,a=t.onLink??t.position,c=o?0:1,l=[a.x,a.y,a.z].map(f=>(f*1e3).toFixed(c)).join(", ");[o?`${ea(o)} ${Sl(t)}`:Sl(t),Gs(i),Qe(s/1e3),Qe(r),Qe(e*1e4),l].forEach((f,u)=>Bt(n.children[u],f))}function Jx({isWhole:n,shown:{status:t,skin:e}}){Bt(J("session-title"),n?"Skins":"Session"),Xr(J("session"),t?jx(t,e):[])}function jx(n,t){let e=n.patch_crc?n.patch_crc.toString(16).padStart(8,"0"):"–";return[["Skin",n.skin||t?.name||"–"],["Board",[n.board,n.firmware&&`firmware ${n.firmware}`].filter(Boolean).join(", ")||"–"],["Port",n.port||"–"],["Patch",`${n.patches[n.patch]??"–"} (${e})`],["Drive",$u(n)],["Frames",`${n.frames}, lost ${n.frames_lost}; damaged packets ${n.packets_damaged}`],["Calibrated",t?t.is_calibrated?"yes: kPa and N":"no: strength only":"–"],...n.recording?[["Recording",`${n.recording}, ${xl(n.recorded_bytes)}`]]:[]]}function $u({frequency:n,amplitude:t,gain:e,frame_rate:i}){let s=e>0?`gain ${e}`:"gain automatic";return`${Vs(n/1e3,"kHz")}, ${Vs(t*1e3,"mA")}, ${s}, ${Vs(i,"frames/s")}`}function Xr(n,t){Gn(n,t,()=>qt("div",{},qt("dt"),qt("dd")),(e,[i,s])=>{Bt(e.firstChild,i),Bt(e.lastChild,String(s))})}var Qp="cividis",Qx=1,tm=24,Al={open:{word:"no contact",shape:"square",sign:"×"},shorted:{word:"connected to a neighbour",shape:"diamond",sign:"="},worse:{word:"touches worse than in the tare",shape:"triangle",sign:"!"},sound:{word:"sound",shape:"circle",sign:""},unknown:{word:"not tested",shape:"circle",sign:""}};function Tl(n,t){let e=em(t?.contact_impedance??[]);return Array.from({length:n},(i,s)=>{let r=t?.contact_impedance[s]??NaN;return{number:s+1,impedance:r,state:tv(s,t),colour:ev(r,e)}})}function tv(n,t){let e=i=>i>>n&1;return t?e(t.open)?"open":e(t.shorted)?"shorted":e(t.worse)?"worse":t.contact_impedance.length>0?"sound":"unknown":"unknown"}function em(n){let t=[...n].filter(r=>Number.isFinite(r)&&r>0).map(Math.log10);if(t.length===0)return;let[e,i]=[Math.min(...t),Math.max(...t)],s=Math.max(0,Qx-(i-e))/2;return[e-s,i+s]}function ev(n,t){if(!t||!(n>0))return;if(!Number.isFinite(n))return wl(ta(Qp,1));let e=(Math.log10(n)-t[0])/(t[1]-t[0]);return wl(ta(Qp,Math.round(e*tm)/tm))}function nm(n){let t=em(n?.contact_impedance??[]);return t?`Dots on the skin: dark ${Qo(10**t[0])}, light ${Qo(10**t[1])}. Square ×: no contact. Diamond =: connected to a neighbour. Triangle !: worse than in the tare.`:"Contact impedances are not measured."}function im(n){return[["Temperature",Number.isFinite(n.temperature)?`${Qe(n.temperature)} °C`:"not measured"],["CPU load",`${Math.round(n.load*100)} %`],["Free stack",`${n.free_stack} bytes`],["Drift taken out",`${Qe(n.drift*100,2)} %`],["Reciprocity error",Number.isFinite(n.reciprocity_error)?`${Qe(n.reciprocity_error*100,2)} %`:"not measured"],["Samples missed",`${n.missed} times`]]}var Pm=Dp(rm(),1),Lm=Dp(Rm(),1),Ln={skin:"/dermatome/skin",status:"/dermatome/status",image:"/dermatome/image",contacts:"/dermatome/contacts",health:"/dermatome/health",scope:"/dermatome/scope"},Qv=["saturated","an electrode without contact","electrodes connected to each other","no current","not reciprocal","implausible","samples missed","electrodes masked","board hot","unlike a press","skin lifted","an electrode touches worse than in the tare"],Im=new Map;function tS(n){let t=Im.get(n);return t||(t=new Lm.MessageReader((0,Pm.parse)(n,{ros2:!0})),Im.set(n,t)),t}function fa(n,t){return tS(n).readMessage(t.slice())}function of({vertices:n,triangles:t,vertex_pixels:e,electrodes:i,link_vertices:s,link_triangles:r}){let o=(c,l)=>c.length%3===0&&l.length%3===0&&l.every(h=>h<c.length/3),a=[n,i,s].every(c=>c.every(Number.isFinite));if(!o(n,t)||!o(s,r)||e.length*3!==n.length||!a)throw new Error("the skin's vertices, triangles and pixels do not fit together")}function Hl(n,t){let{mantissas:e,exponent:i}=n;t?.length!==e.length&&(t=new Float32Array(e.length));let s=2**-i;for(let r=0;r<e.length;r++)t[r]=e[r]*s;return t}function Dm(n){return Qv.filter((t,e)=>n&1<<e)}var eS=250;function Nm(n){let t=!1,e=0,i=r=>{let o=performance.now()-e>eS&&(r.has("health")||r.has("skin"));!t||!(o||r.has("new"))||(e=performance.now(),nS(n.shown))};return n.listen(i),rS(n),{setSeen:r=>{t=r,i(new Set(["new"]))}}}function nS({skin:n,health:t}){let e=Math.max((n?.electrodes.length??0)/3,t?.contact_impedance.length??0);Bt(J("electrode-legend"),e>0?nm(t):"No skin is known yet."),Gn(J("electrode-rows"),Tl(e,t),iS,sS);let i=t?Dm(t.flags):[];Xr(J("health"),t?[...im(t),["Latest frame",i.join(", ")||"sound"]]:[])}function iS(){let n=qt("span",{className:"swatch","aria-hidden":"true"});return qt("tr",{},qt("th",{scope:"row"}),qt("td",{},n,qt("span")),qt("td"))}function sS(n,{number:t,impedance:e,state:i,colour:s}){let{word:r,sign:o}=Al[i];n.dataset.state=i,Bt(n.children[0],String(t)),n.children[1].firstChild.style.background=s??"transparent",Bt(n.children[1].lastChild,Qo(e)),Bt(n.children[2],o?`${o} ${r}`:r)}function rS(n){let t=J("check"),e=J("said-check"),i=!1,s=()=>t.disabled=i||!n.offers("/dermatome/check");n.listen(s),t.addEventListener("click",async()=>{i=!0,s(),J("check-result").replaceChildren(),Bt(e,"Checking. Do not touch the skin."),e.dataset.kind="progress";try{oS(await n.call("/dermatome/check")),Bt(e,"")}catch(r){e.dataset.kind="error",Bt(e,r.message)}i=!1,s(),Bt(t,"Check again")})}function oS({summary:n=[],findings:t=[]}){let e=n.map(r=>qt("p",{},r)),i=t.map(({level:r,found:o,advice:a})=>qt("li",{"data-level":r==="fault"?"fault":"note"},qt("strong",{},`${r==="fault"?"Fault":"Note"}: ${o}`),qt("span",{},a??""))),s=i.length>0?qt("ul",{className:"findings"},...i):qt("p",{className:"good"},"Nothing wrong was found.");J("check-result").replaceChildren(...e,s)}var Bi=[{name:"contacts",title:"Contacts"},{name:"plots",title:"Plots"},{name:"settings",title:"Settings"},{name:"electrodes",title:"Electrodes"},{name:"calibrate",title:"Calibrate"},{name:"scope",title:"Scope"}],Vl=class{constructor(t){this.onSelect=t,this.selected=void 0,J("tabs").append(...Bi.map((e,i)=>this.makeTab(e,i))),J("tabs").addEventListener("keydown",e=>this.move(e));for(let{name:e}of Bi)J(`panel-${e}`).setAttribute("role","tabpanel"),J(`panel-${e}`).setAttribute("aria-labelledby",`tab-${e}`)}makeTab({name:t,title:e},i){let s=qt("button",{type:"button",id:`tab-${t}`,role:"tab","aria-controls":`panel-${t}`,title:`${e} (${i+1})`},e);return s.addEventListener("click",()=>this.select(t)),s}select(t){this.selected=t;for(let{name:e}of Bi){let i=J(`tab-${e}`);i.setAttribute("aria-selected",String(e===t)),i.tabIndex=e===t?0:-1,J(`panel-${e}`).hidden=e!==t}this.onSelect(t)}move(t){let e={ArrowLeft:-1,ArrowRight:1}[t.key];if(!e)return;t.preventDefault(),t.stopPropagation();let i=Bi.findIndex(({name:r})=>r===this.selected),s=Bi[(i+e+Bi.length)%Bi.length].name;this.select(s),J(`tab-${s}`).focus()}};var Om=Math.PI/36,Um=1.1;function Bm(n,t){let e=J("help"),i=aS(n,t);lS(i),J("help-button").addEventListener("click",()=>e.showModal()),e.addEventListener("click",s=>s.target===e&&e.close()),addEventListener("keydown",s=>{if(s.key==="?"&&!Fm(s.target))return s.preventDefault(),e.open?e.close():e.showModal();if(e.open||Fm(s.target)||s.ctrlKey||s.metaKey||s.altKey)return;let r=i.find(({matches:o})=>o(s));r&&(s.preventDefault(),r.act(s))})}function aS(n,t){let e=a=>c=>c.key.toLowerCase()===a&&!c.shiftKey,i=a=>a.key===" "&&!(a.target instanceof HTMLButtonElement),s={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,-1],ArrowDown:[0,1]},r=a=>a.target===J("canvas"),o=a=>n.player&&!a.shiftKey&&["ArrowLeft","ArrowRight"].includes(a.key);return[{name:"t",does:"Tare",matches:e("t"),act:t.tare},{name:"r",does:"Start or stop recording",matches:e("r"),act:t.record},{name:"Space",does:"Pause the picture; play or pause a recording",matches:i,act:t.hold},{name:"← →",does:"Previous or next frame of a recording",matches:o,act:a=>t.step(a.key==="ArrowRight")},{name:"o",does:"Open a recording",matches:e("o"),act:t.open},{name:"c",does:"Next colour map",matches:e("c"),act:t.map},{name:"a",does:"Colour scale: automatic or fixed",matches:e("a"),act:t.automatic},{name:"[ ]",does:"Colour scale: smaller or larger",matches:({key:a})=>a==="["||a==="]",act:({key:a})=>t.scale(a==="]")},{name:"e",does:"Show or hide electrodes",matches:e("e"),act:t.electrodes},{name:"v",does:"Show all of the skin",matches:e("v"),act:t.reset},{name:"Arrows",does:"On the picture: turn it (with Shift while a recording is shown)",matches:a=>r(a)&&a.key in s,act:({key:a})=>t.turn(s[a][0]*Om,s[a][1]*Om)},{name:"+ −",does:"On the picture: nearer or farther",matches:a=>r(a)&&["+","=","-"].includes(a.key),act:({key:a})=>t.zoom(a==="-"?Um:1/Um)},{name:`1 – ${Bi.length}`,does:"Panels, from left to right",matches:({key:a})=>a>="1"&&a<=String(Bi.length),act:({key:a})=>t.panel(Bi[a-1].name)},{name:"?",does:"This help",matches:()=>!1},{name:"Esc",does:"Close this help or a message",matches:e("escape"),act:t.dismiss}]}function lS(n){let t=n.map(({name:e,does:i})=>qt("div",{},qt("dt",{},qt("kbd",{},e)),qt("dd",{},i)));J("keys").replaceChildren(...t)}function Fm(n){return n instanceof HTMLSelectElement||n instanceof HTMLTextAreaElement?!0:n instanceof HTMLInputElement&&!["checkbox","radio","range","file"].includes(n.type)}var sr={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},rr={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},dg=0,Of=1,pg=2;var $a=1,mg=2,wo=3,or=0,ii=1,si=2,br=0,Mo=1,Uf=2,Ff=3,Bf=4,gg=5;var wr=100,_g=101,yg=102,xg=103,vg=104,Sg=200,bg=201,wg=202,Mg=203,kf=204,zf=205,Eg=206,Ag=207,Tg=208,Cg=209,Rg=210,Ig=211,Pg=212,Lg=213,Dg=214,dc=0,pc=1,mc=2,co=3,gc=4,_c=5,yc=6,xc=7,$c=0,Ng=1,Og=2,cs=0,Hf=1,Vf=2,Gf=3,Wf=4,$f=5,Xf=6,qf=7;var Yf=300,Mr=301,Eo=302,Xc=303,qc=304,vc=1e3,as=1001,Sc=1002,Nn=1003,Ug=1004;var Xa=1005;var Bn=1006,Yc=1007;var Is=1008;var hi=1009,Zf=1010,Kf=1011,Ao=1012,Zc=1013,Gi=1014,Wi=1015,$i=1016,Kc=1017,Jc=1018,Er=1020,Jf=35902,jf=35899,Qf=1021,td=1022,Xi=1023,Es=1026,Ps=1027,ed=1028,jc=1029,ar=1030,Qc=1031;var th=1033,qa=33776,Ya=33777,Za=33778,Ka=33779,eh=35840,nh=35841,ih=35842,sh=35843,rh=36196,oh=37492,ah=37496,lh=37488,ch=37489,Ja=37490,hh=37491,uh=37808,fh=37809,dh=37810,ph=37811,mh=37812,gh=37813,_h=37814,yh=37815,xh=37816,vh=37817,Sh=37818,bh=37819,wh=37820,Mh=37821,Eh=36492,Ah=36494,Th=36495,Ch=36283,Rh=36284,ja=36285,Ih=36286;var Sa=2300,bc=2301,uc=2302,Cf=2303,Rf=2400,If=2401,Pf=2402;var Fg=3200;var Ph=0,Bg=1,Ls="",yi="srgb",ba="srgb-linear",wa="linear",Ie="srgb";var fc=7680;var kg=519,zg=512,Hg=513,Vg=514,nd=515,Gg=516,Wg=517,id=518,sd=519,$g=35044;var rd="300 es",Ii=2e3,ho=2001;function cS(n){for(let t=n.length-1;t>=0;--t)if(n[t]>=65535)return!0;return!1}function hS(n){return ArrayBuffer.isView(n)&&!(n instanceof DataView)}function Ma(n){return document.createElementNS("http://www.w3.org/1999/xhtml",n)}function Xg(){let n=Ma("canvas");return n.style.display="block",n}var km={},uo=null;function od(...n){let t="THREE."+n.shift();uo?uo("log",t,...n):console.log(t,...n)}function qg(n){let t=n[0];if(typeof t=="string"&&t.startsWith("TSL:")){let e=n[1];e&&e.isStackTrace?n[0]+=" "+e.getLocation():n[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return n}function Kt(...n){n=qg(n);let t="THREE."+n.shift();if(uo)uo("warn",t,...n);else{let e=n[0];e&&e.isStackTrace?console.warn(e.getError(t)):console.warn(t,...n)}}function re(...n){n=qg(n);let t="THREE."+n.shift();if(uo)uo("error",t,...n);else{let e=n[0];e&&e.isStackTrace?console.error(e.getError(t)):console.error(t,...n)}}function ya(...n){let t=n.join(" ");t in km||(km[t]=!0,Kt(...n))}function Yg(n,t,e){return new Promise(function(i,s){function r(){switch(n.clientWaitSync(t,n.SYNC_FLUSH_COMMANDS_BIT,0)){case n.WAIT_FAILED:s();break;case n.TIMEOUT_EXPIRED:setTimeout(r,e);break;default:i()}}setTimeout(r,e)})}var Zg={[dc]:dc,[mc]:yc,[gc]:gc,[co]:_c,[pc]:pc,[yc]:mc,[xc]:xc,[_c]:co},Vi=class{addEventListener(t,e){this._listeners===void 0&&(this._listeners={});let i=this._listeners;i[t]===void 0&&(i[t]=[]),i[t].indexOf(e)===-1&&i[t].push(e)}hasEventListener(t,e){let i=this._listeners;return i===void 0?!1:i[t]!==void 0&&i[t].indexOf(e)!==-1}removeEventListener(t,e){let i=this._listeners;if(i===void 0)return;let s=i[t];if(s!==void 0){let r=s.indexOf(e);r!==-1&&s.splice(r,1)}}dispatchEvent(t){let e=this._listeners;if(e===void 0)return;let i=e[t.type];if(i!==void 0){t.target=this;let s=i.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,t);t.target=null}}},Wn=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],zm=1234567,xa=Math.PI/180,fo=180/Math.PI;function To(){let n=Math.random()*4294967295|0,t=Math.random()*4294967295|0,e=Math.random()*4294967295|0,i=Math.random()*4294967295|0;return(Wn[n&255]+Wn[n>>8&255]+Wn[n>>16&255]+Wn[n>>24&255]+"-"+Wn[t&255]+Wn[t>>8&255]+"-"+Wn[t>>16&15|64]+Wn[t>>24&255]+"-"+Wn[e&63|128]+Wn[e>>8&255]+"-"+Wn[e>>16&255]+Wn[e>>24&255]+Wn[i&255]+Wn[i>>8&255]+Wn[i>>16&255]+Wn[i>>24&255]).toLowerCase()}function me(n,t,e){return Math.max(t,Math.min(e,n))}function ad(n,t){return(n%t+t)%t}function uS(n,t,e,i,s){return i+(n-t)*(s-i)/(e-t)}function fS(n,t,e){return n!==t?(e-n)/(t-n):0}function va(n,t,e){return(1-e)*n+e*t}function dS(n,t,e,i){return va(n,t,1-Math.exp(-e*i))}function pS(n,t=1){return t-Math.abs(ad(n,t*2)-t)}function mS(n,t,e){return n<=t?0:n>=e?1:(n=(n-t)/(e-t),n*n*(3-2*n))}function gS(n,t,e){return n<=t?0:n>=e?1:(n=(n-t)/(e-t),n*n*n*(n*(n*6-15)+10))}function _S(n,t){return n+Math.floor(Math.random()*(t-n+1))}function yS(n,t){return n+Math.random()*(t-n)}function xS(n){return n*(.5-Math.random())}function vS(n){n!==void 0&&(zm=n);let t=zm+=1831565813;return t=Math.imul(t^t>>>15,t|1),t^=t+Math.imul(t^t>>>7,t|61),((t^t>>>14)>>>0)/4294967296}function SS(n){return n*xa}function bS(n){return n*fo}function wS(n){return n>0&&Number.isInteger(n)&&2**Math.round(Math.log2(n))===n}function MS(n){return Math.pow(2,Math.ceil(Math.log(n)/Math.LN2))}function ld(n){return Math.pow(2,Math.floor(Math.log(n)/Math.LN2))}function ES(n,t,e,i,s){let r=Math.cos,o=Math.sin,a=r(e/2),c=o(e/2),l=r((t+i)/2),h=o((t+i)/2),f=r((t-i)/2),u=o((t-i)/2),d=r((i-t)/2),p=o((i-t)/2);switch(s){case"XYX":n.set(a*h,c*f,c*u,a*l);break;case"YZY":n.set(c*u,a*h,c*f,a*l);break;case"ZXZ":n.set(c*f,c*u,a*h,a*l);break;case"XZX":n.set(a*h,c*p,c*d,a*l);break;case"YXY":n.set(c*d,a*h,c*p,a*l);break;case"ZYZ":n.set(c*p,c*d,a*h,a*l);break;default:Kt("MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function cd(n){switch(n.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function Kg(n,t){if(t.constructor===Float32Array)return n;let e=cd(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(n/e,-1)}function Jg(n,t){if(t.constructor===Float32Array)return n;let e=cd(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(n*e)}var hd={DEG2RAD:xa,RAD2DEG:fo,generateUUID:To,clamp:me,euclideanModulo:ad,mapLinear:uS,inverseLerp:fS,lerp:va,damp:dS,pingpong:pS,smoothstep:mS,smootherstep:gS,randInt:_S,randFloat:yS,randFloatSpread:xS,seededRandom:vS,degToRad:SS,radToDeg:bS,isPowerOfTwo:wS,ceilPowerOfTwo:MS,floorPowerOfTwo:ld,setQuaternionFromProperEuler:ES,normalize:Jg,denormalize:Kg},jt=class{static{this.prototype.isVector2=!0}constructor(t=0,e=0){this.x=t,this.y=e}get width(){return this.x}set width(t){this.x=t}get height(){return this.y}set height(t){this.y=t}set(t,e){return this.x=t,this.y=e,this}setScalar(t){return this.x=t,this.y=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;default:throw new Error("THREE.Vector2: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y)}copy(t){return this.x=t.x,this.y=t.y,this}add(t){return this.x+=t.x,this.y+=t.y,this}addScalar(t){return this.x+=t,this.y+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this}subScalar(t){return this.x-=t,this.y-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this}multiply(t){return this.x*=t.x,this.y*=t.y,this}multiplyScalar(t){return this.x*=t,this.y*=t,this}divide(t){return this.x/=t.x,this.y/=t.y,this}divideScalar(t){return this.multiplyScalar(1/t)}applyMatrix3(t){let e=this.x,i=this.y,s=t.elements;return this.x=s[0]*e+s[3]*i+s[6],this.y=s[1]*e+s[4]*i+s[7],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this}clamp(t,e){return this.x=me(this.x,t.x,e.x),this.y=me(this.y,t.y,e.y),this}clampScalar(t,e){return this.x=me(this.x,t,e),this.y=me(this.y,t,e),this}clampLength(t,e){let i=this.length();return this.divideScalar(i||1).multiplyScalar(me(i,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(t){return this.x*t.x+this.y*t.y}cross(t){return this.x*t.y-this.y*t.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let i=this.dot(t)/e;return Math.acos(me(i,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,i=this.y-t.y;return e*e+i*i}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this}lerpVectors(t,e,i){return this.x=t.x+(e.x-t.x)*i,this.y=t.y+(e.y-t.y)*i,this}equals(t){return t.x===this.x&&t.y===this.y}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this}rotateAround(t,e){let i=Math.cos(e),s=Math.sin(e),r=this.x-t.x,o=this.y-t.y;return this.x=r*i-o*s+t.x,this.y=r*s+o*i+t.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},kn=class{constructor(t=0,e=0,i=0,s=1){this.isQuaternion=!0,this._x=t,this._y=e,this._z=i,this._w=s}static slerpFlat(t,e,i,s,r,o,a){let c=i[s+0],l=i[s+1],h=i[s+2],f=i[s+3],u=r[o+0],d=r[o+1],p=r[o+2],_=r[o+3];if(f!==_||c!==u||l!==d||h!==p){let m=c*u+l*d+h*p+f*_;m<0&&(u=-u,d=-d,p=-p,_=-_,m=-m);let g=1-a;if(m<.9995){let v=Math.acos(m),T=Math.sin(v);g=Math.sin(g*v)/T,a=Math.sin(a*v)/T,c=c*g+u*a,l=l*g+d*a,h=h*g+p*a,f=f*g+_*a}else{c=c*g+u*a,l=l*g+d*a,h=h*g+p*a,f=f*g+_*a;let v=1/Math.sqrt(c*c+l*l+h*h+f*f);c*=v,l*=v,h*=v,f*=v}}t[e]=c,t[e+1]=l,t[e+2]=h,t[e+3]=f}static multiplyQuaternionsFlat(t,e,i,s,r,o){let a=i[s],c=i[s+1],l=i[s+2],h=i[s+3],f=r[o],u=r[o+1],d=r[o+2],p=r[o+3];return t[e]=a*p+h*f+c*d-l*u,t[e+1]=c*p+h*u+l*f-a*d,t[e+2]=l*p+h*d+a*u-c*f,t[e+3]=h*p-a*f-c*u-l*d,t}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get w(){return this._w}set w(t){this._w=t,this._onChangeCallback()}set(t,e,i,s){return this._x=t,this._y=e,this._z=i,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(t){return this._x=t.x,this._y=t.y,this._z=t.z,this._w=t.w,this._onChangeCallback(),this}setFromEuler(t,e=!0){let i=t._x,s=t._y,r=t._z,o=t._order,a=Math.cos,c=Math.sin,l=a(i/2),h=a(s/2),f=a(r/2),u=c(i/2),d=c(s/2),p=c(r/2);switch(o){case"XYZ":this._x=u*h*f+l*d*p,this._y=l*d*f-u*h*p,this._z=l*h*p+u*d*f,this._w=l*h*f-u*d*p;break;case"YXZ":this._x=u*h*f+l*d*p,this._y=l*d*f-u*h*p,this._z=l*h*p-u*d*f,this._w=l*h*f+u*d*p;break;case"ZXY":this._x=u*h*f-l*d*p,this._y=l*d*f+u*h*p,this._z=l*h*p+u*d*f,this._w=l*h*f-u*d*p;break;case"ZYX":this._x=u*h*f-l*d*p,this._y=l*d*f+u*h*p,this._z=l*h*p-u*d*f,this._w=l*h*f+u*d*p;break;case"YZX":this._x=u*h*f+l*d*p,this._y=l*d*f+u*h*p,this._z=l*h*p-u*d*f,this._w=l*h*f-u*d*p;break;case"XZY":this._x=u*h*f-l*d*p,this._y=l*d*f-u*h*p,this._z=l*h*p+u*d*f,this._w=l*h*f+u*d*p;break;default:Kt("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return e===!0&&this._onChangeCallback(),this}setFromAxisAngle(t,e){let i=e/2,s=Math.sin(i);return this._x=t.x*s,this._y=t.y*s,this._z=t.z*s,this._w=Math.cos(i),this._onChangeCallback(),this}setFromRotationMatrix(t){let e=t.elements,i=e[0],s=e[4],r=e[8],o=e[1],a=e[5],c=e[9],l=e[2],h=e[6],f=e[10],u=i+a+f;if(u>0){let d=.5/Math.sqrt(u+1);this._w=.25/d,this._x=(h-c)*d,this._y=(r-l)*d,this._z=(o-s)*d}else if(i>a&&i>f){let d=2*Math.sqrt(1+i-a-f);this._w=(h-c)/d,this._x=.25*d,this._y=(s+o)/d,this._z=(r+l)/d}else if(a>f){let d=2*Math.sqrt(1+a-i-f);this._w=(r-l)/d,this._x=(s+o)/d,this._y=.25*d,this._z=(c+h)/d}else{let d=2*Math.sqrt(1+f-i-a);this._w=(o-s)/d,this._x=(r+l)/d,this._y=(c+h)/d,this._z=.25*d}return this._onChangeCallback(),this}setFromUnitVectors(t,e){let i=t.dot(e)+1;return i<1e-8?(i=0,Math.abs(t.x)>Math.abs(t.z)?(this._x=-t.y,this._y=t.x,this._z=0,this._w=i):(this._x=0,this._y=-t.z,this._z=t.y,this._w=i)):(this._x=t.y*e.z-t.z*e.y,this._y=t.z*e.x-t.x*e.z,this._z=t.x*e.y-t.y*e.x,this._w=i),this.normalize()}angleTo(t){return 2*Math.acos(Math.abs(me(this.dot(t),-1,1)))}rotateTowards(t,e){let i=this.angleTo(t);if(i===0)return this;let s=Math.min(1,e/i);return this.slerp(t,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(t){return this._x*t._x+this._y*t._y+this._z*t._z+this._w*t._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let t=this.length();return t===0?(this._x=0,this._y=0,this._z=0,this._w=1):(t=1/t,this._x=this._x*t,this._y=this._y*t,this._z=this._z*t,this._w=this._w*t),this._onChangeCallback(),this}multiply(t){return this.multiplyQuaternions(this,t)}premultiply(t){return this.multiplyQuaternions(t,this)}multiplyQuaternions(t,e){let i=t._x,s=t._y,r=t._z,o=t._w,a=e._x,c=e._y,l=e._z,h=e._w;return this._x=i*h+o*a+s*l-r*c,this._y=s*h+o*c+r*a-i*l,this._z=r*h+o*l+i*c-s*a,this._w=o*h-i*a-s*c-r*l,this._onChangeCallback(),this}slerp(t,e){let i=t._x,s=t._y,r=t._z,o=t._w,a=this.dot(t);a<0&&(i=-i,s=-s,r=-r,o=-o,a=-a);let c=1-e;if(a<.9995){let l=Math.acos(a),h=Math.sin(l);c=Math.sin(c*l)/h,e=Math.sin(e*l)/h,this._x=this._x*c+i*e,this._y=this._y*c+s*e,this._z=this._z*c+r*e,this._w=this._w*c+o*e,this._onChangeCallback()}else this._x=this._x*c+i*e,this._y=this._y*c+s*e,this._z=this._z*c+r*e,this._w=this._w*c+o*e,this.normalize();return this}slerpQuaternions(t,e,i){return this.copy(t).slerp(e,i)}random(){let t=2*Math.PI*Math.random(),e=2*Math.PI*Math.random(),i=Math.random(),s=Math.sqrt(1-i),r=Math.sqrt(i);return this.set(s*Math.sin(t),s*Math.cos(t),r*Math.sin(e),r*Math.cos(e))}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._w===this._w}fromArray(t,e=0){return this._x=t[e],this._y=t[e+1],this._z=t[e+2],this._w=t[e+3],this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._w,t}fromBufferAttribute(t,e){return this._x=t.getX(e),this._y=t.getY(e),this._z=t.getZ(e),this._w=t.getW(e),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},$=class{static{this.prototype.isVector3=!0}constructor(t=0,e=0,i=0){this.x=t,this.y=e,this.z=i}set(t,e,i){return i===void 0&&(i=this.z),this.x=t,this.y=e,this.z=i,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;default:throw new Error("THREE.Vector3: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this}multiplyVectors(t,e){return this.x=t.x*e.x,this.y=t.y*e.y,this.z=t.z*e.z,this}applyEuler(t){return this.applyQuaternion(Hm.setFromEuler(t))}applyAxisAngle(t,e){return this.applyQuaternion(Hm.setFromAxisAngle(t,e))}applyMatrix3(t){let e=this.x,i=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[3]*i+r[6]*s,this.y=r[1]*e+r[4]*i+r[7]*s,this.z=r[2]*e+r[5]*i+r[8]*s,this}applyNormalMatrix(t){return this.applyMatrix3(t).normalize()}applyMatrix4(t){let e=this.x,i=this.y,s=this.z,r=t.elements,o=1/(r[3]*e+r[7]*i+r[11]*s+r[15]);return this.x=(r[0]*e+r[4]*i+r[8]*s+r[12])*o,this.y=(r[1]*e+r[5]*i+r[9]*s+r[13])*o,this.z=(r[2]*e+r[6]*i+r[10]*s+r[14])*o,this}applyQuaternion(t){let e=this.x,i=this.y,s=this.z,r=t.x,o=t.y,a=t.z,c=t.w,l=2*(o*s-a*i),h=2*(a*e-r*s),f=2*(r*i-o*e);return this.x=e+c*l+o*f-a*h,this.y=i+c*h+a*l-r*f,this.z=s+c*f+r*h-o*l,this}project(t){return this.applyMatrix4(t.matrixWorldInverse).applyMatrix4(t.projectionMatrix)}unproject(t){return this.applyMatrix4(t.projectionMatrixInverse).applyMatrix4(t.matrixWorld)}transformDirection(t){let e=this.x,i=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[4]*i+r[8]*s,this.y=r[1]*e+r[5]*i+r[9]*s,this.z=r[2]*e+r[6]*i+r[10]*s,this.normalize()}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this}divideScalar(t){return this.multiplyScalar(1/t)}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this}clamp(t,e){return this.x=me(this.x,t.x,e.x),this.y=me(this.y,t.y,e.y),this.z=me(this.z,t.z,e.z),this}clampScalar(t,e){return this.x=me(this.x,t,e),this.y=me(this.y,t,e),this.z=me(this.z,t,e),this}clampLength(t,e){let i=this.length();return this.divideScalar(i||1).multiplyScalar(me(i,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this}lerpVectors(t,e,i){return this.x=t.x+(e.x-t.x)*i,this.y=t.y+(e.y-t.y)*i,this.z=t.z+(e.z-t.z)*i,this}cross(t){return this.crossVectors(this,t)}crossVectors(t,e){let i=t.x,s=t.y,r=t.z,o=e.x,a=e.y,c=e.z;return this.x=s*c-r*a,this.y=r*o-i*c,this.z=i*a-s*o,this}projectOnVector(t){let e=t.lengthSq();if(e===0)return this.set(0,0,0);let i=t.dot(this)/e;return this.copy(t).multiplyScalar(i)}projectOnPlane(t){return af.copy(this).projectOnVector(t),this.sub(af)}reflect(t){return this.sub(af.copy(t).multiplyScalar(2*this.dot(t)))}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let i=this.dot(t)/e;return Math.acos(me(i,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,i=this.y-t.y,s=this.z-t.z;return e*e+i*i+s*s}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)+Math.abs(this.z-t.z)}setFromSpherical(t){return this.setFromSphericalCoords(t.radius,t.phi,t.theta)}setFromSphericalCoords(t,e,i){let s=Math.sin(e)*t;return this.x=s*Math.sin(i),this.y=Math.cos(e)*t,this.z=s*Math.cos(i),this}setFromCylindrical(t){return this.setFromCylindricalCoords(t.radius,t.theta,t.y)}setFromCylindricalCoords(t,e,i){return this.x=t*Math.sin(e),this.y=i,this.z=t*Math.cos(e),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this}setFromMatrixScale(t){let e=this.setFromMatrixColumn(t,0).length(),i=this.setFromMatrixColumn(t,1).length(),s=this.setFromMatrixColumn(t,2).length();return this.x=e,this.y=i,this.z=s,this}setFromMatrixColumn(t,e){return this.fromArray(t.elements,e*4)}setFromMatrix3Column(t,e){return this.fromArray(t.elements,e*3)}setFromEuler(t){return this.x=t._x,this.y=t._y,this.z=t._z,this}setFromColor(t){return this.x=t.r,this.y=t.g,this.z=t.b,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let t=Math.random()*Math.PI*2,e=Math.random()*2-1,i=Math.sqrt(1-e*e);return this.x=i*Math.cos(t),this.y=e,this.z=i*Math.sin(t),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},af=new $,Hm=new kn,oe=class{static{this.prototype.isMatrix3=!0}constructor(t,e,i,s,r,o,a,c,l){this.elements=[1,0,0,0,1,0,0,0,1],t!==void 0&&this.set(t,e,i,s,r,o,a,c,l)}set(t,e,i,s,r,o,a,c,l){let h=this.elements;return h[0]=t,h[1]=s,h[2]=a,h[3]=e,h[4]=r,h[5]=c,h[6]=i,h[7]=o,h[8]=l,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(t){let e=this.elements,i=t.elements;return e[0]=i[0],e[1]=i[1],e[2]=i[2],e[3]=i[3],e[4]=i[4],e[5]=i[5],e[6]=i[6],e[7]=i[7],e[8]=i[8],this}extractBasis(t,e,i){return t.setFromMatrix3Column(this,0),e.setFromMatrix3Column(this,1),i.setFromMatrix3Column(this,2),this}setFromMatrix4(t){let e=t.elements;return this.set(e[0],e[4],e[8],e[1],e[5],e[9],e[2],e[6],e[10]),this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let i=t.elements,s=e.elements,r=this.elements,o=i[0],a=i[3],c=i[6],l=i[1],h=i[4],f=i[7],u=i[2],d=i[5],p=i[8],_=s[0],m=s[3],g=s[6],v=s[1],T=s[4],S=s[7],C=s[2],E=s[5],y=s[8];return r[0]=o*_+a*v+c*C,r[3]=o*m+a*T+c*E,r[6]=o*g+a*S+c*y,r[1]=l*_+h*v+f*C,r[4]=l*m+h*T+f*E,r[7]=l*g+h*S+f*y,r[2]=u*_+d*v+p*C,r[5]=u*m+d*T+p*E,r[8]=u*g+d*S+p*y,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[3]*=t,e[6]*=t,e[1]*=t,e[4]*=t,e[7]*=t,e[2]*=t,e[5]*=t,e[8]*=t,this}determinant(){let t=this.elements,e=t[0],i=t[1],s=t[2],r=t[3],o=t[4],a=t[5],c=t[6],l=t[7],h=t[8];return e*o*h-e*a*l-i*r*h+i*a*c+s*r*l-s*o*c}invert(){let t=this.elements,e=t[0],i=t[1],s=t[2],r=t[3],o=t[4],a=t[5],c=t[6],l=t[7],h=t[8],f=h*o-a*l,u=a*c-h*r,d=l*r-o*c,p=e*f+i*u+s*d;if(p===0)return this.set(0,0,0,0,0,0,0,0,0);let _=1/p;return t[0]=f*_,t[1]=(s*l-h*i)*_,t[2]=(a*i-s*o)*_,t[3]=u*_,t[4]=(h*e-s*c)*_,t[5]=(s*r-a*e)*_,t[6]=d*_,t[7]=(i*c-l*e)*_,t[8]=(o*e-i*r)*_,this}transpose(){let t,e=this.elements;return t=e[1],e[1]=e[3],e[3]=t,t=e[2],e[2]=e[6],e[6]=t,t=e[5],e[5]=e[7],e[7]=t,this}getNormalMatrix(t){return this.setFromMatrix4(t).invert().transpose()}transposeIntoArray(t){let e=this.elements;return t[0]=e[0],t[1]=e[3],t[2]=e[6],t[3]=e[1],t[4]=e[4],t[5]=e[7],t[6]=e[2],t[7]=e[5],t[8]=e[8],this}setUvTransform(t,e,i,s,r,o,a){let c=Math.cos(r),l=Math.sin(r);return this.set(i*c,i*l,-i*(c*o+l*a)+o+t,-s*l,s*c,-s*(-l*o+c*a)+a+e,0,0,1),this}scale(t,e){return ya("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(lf.makeScale(t,e)),this}rotate(t){return ya("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(lf.makeRotation(-t)),this}translate(t,e){return ya("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(lf.makeTranslation(t,e)),this}makeTranslation(t,e){return t.isVector2?this.set(1,0,t.x,0,1,t.y,0,0,1):this.set(1,0,t,0,1,e,0,0,1),this}makeRotation(t){let e=Math.cos(t),i=Math.sin(t);return this.set(e,-i,0,i,e,0,0,0,1),this}makeScale(t,e){return this.set(t,0,0,0,e,0,0,0,1),this}equals(t){let e=this.elements,i=t.elements;for(let s=0;s<9;s++)if(e[s]!==i[s])return!1;return!0}fromArray(t,e=0){for(let i=0;i<9;i++)this.elements[i]=t[i+e];return this}toArray(t=[],e=0){let i=this.elements;return t[e]=i[0],t[e+1]=i[1],t[e+2]=i[2],t[e+3]=i[3],t[e+4]=i[4],t[e+5]=i[5],t[e+6]=i[6],t[e+7]=i[7],t[e+8]=i[8],t}clone(){return new this.constructor().fromArray(this.elements)}},lf=new oe,Vm=new oe().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),Gm=new oe().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function AS(){let n={enabled:!0,workingColorSpace:ba,spaces:{},convert:function(s,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===Ie&&(s.r=Ms(s.r),s.g=Ms(s.g),s.b=Ms(s.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(s.applyMatrix3(this.spaces[r].toXYZ),s.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===Ie&&(s.r=lo(s.r),s.g=lo(s.g),s.b=lo(s.b))),s},workingToColorSpace:function(s,r){return this.convert(s,this.workingColorSpace,r)},colorSpaceToWorking:function(s,r){return this.convert(s,r,this.workingColorSpace)},getPrimaries:function(s){return this.spaces[s].primaries},getTransfer:function(s){return s===Ls?wa:this.spaces[s].transfer},getToneMappingMode:function(s){return this.spaces[s].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(s,r=this.workingColorSpace){return s.fromArray(this.spaces[r].luminanceCoefficients)},define:function(s){Object.assign(this.spaces,s)},_getMatrix:function(s,r,o){return s.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(s){return this.spaces[s].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(s=this.workingColorSpace){return this.spaces[s].workingColorSpaceConfig.unpackColorSpace}},t=[.64,.33,.3,.6,.15,.06],e=[.2126,.7152,.0722],i=[.3127,.329];return n.define({[ba]:{primaries:t,whitePoint:i,transfer:wa,toXYZ:Vm,fromXYZ:Gm,luminanceCoefficients:e,workingColorSpaceConfig:{unpackColorSpace:yi},outputColorSpaceConfig:{drawingBufferColorSpace:yi}},[yi]:{primaries:t,whitePoint:i,transfer:Ie,toXYZ:Vm,fromXYZ:Gm,luminanceCoefficients:e,outputColorSpaceConfig:{drawingBufferColorSpace:yi}}}),n}var ye=AS();function Ms(n){return n<.04045?n*.0773993808:Math.pow(n*.9478672986+.0521327014,2.4)}function lo(n){return n<.0031308?n*12.92:1.055*Math.pow(n,.41666)-.055}var Zr,wc=class{static getDataURL(t,e="image/png"){if(/^data:/i.test(t.src)||typeof HTMLCanvasElement>"u")return t.src;let i;if(t instanceof HTMLCanvasElement)i=t;else{Zr===void 0&&(Zr=Ma("canvas")),Zr.width=t.width,Zr.height=t.height;let s=Zr.getContext("2d");t instanceof ImageData?s.putImageData(t,0,0):s.drawImage(t,0,0,t.width,t.height),i=Zr}return i.toDataURL(e)}static sRGBToLinear(t){if(typeof HTMLImageElement<"u"&&t instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&t instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&t instanceof ImageBitmap){let e=Ma("canvas");e.width=t.width,e.height=t.height;let i=e.getContext("2d");i.drawImage(t,0,0,t.width,t.height);let s=i.getImageData(0,0,t.width,t.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=Ms(r[o]/255)*255;return i.putImageData(s,0,0),e}else if(t.data){let e=t.data.slice(0);for(let i=0;i<e.length;i++)e instanceof Uint8Array||e instanceof Uint8ClampedArray?e[i]=Math.floor(Ms(e[i]/255)*255):e[i]=Ms(e[i]);return{data:e,width:t.width,height:t.height}}else return Kt("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),t}},TS=0,po=class{constructor(t=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:TS++}),this.uuid=To(),this.data=t,this.dataReady=!0,this.version=0}getSize(t){let e=this.data;return typeof HTMLVideoElement<"u"&&e instanceof HTMLVideoElement?t.set(e.videoWidth,e.videoHeight,0):typeof VideoFrame<"u"&&e instanceof VideoFrame?t.set(e.displayWidth,e.displayHeight,0):e!==null?t.set(e.width||0,e.height||0,e.depth||0):t.set(0,0,0),t}set needsUpdate(t){t===!0&&this.version++}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.images[this.uuid]!==void 0)return t.images[this.uuid];let i={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(cf(s[o].image)):r.push(cf(s[o]))}else r=cf(s);i.url=r}return e||(t.images[this.uuid]=i),i}};function cf(n){return typeof HTMLImageElement<"u"&&n instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&n instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&n instanceof ImageBitmap?wc.getDataURL(n):n.data?{data:Array.from(n.data),width:n.width,height:n.height,type:n.data.constructor.name}:(Kt("Texture: Unable to serialize Texture."),{})}var CS=0,hf=new $,ci=class n extends Vi{constructor(t=n.DEFAULT_IMAGE,e=n.DEFAULT_MAPPING,i=as,s=as,r=Bn,o=Is,a=Xi,c=hi,l=n.DEFAULT_ANISOTROPY,h=Ls){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:CS++}),this.uuid=To(),this.name="",this.source=new po(t),this.mipmaps=[],this.mapping=e,this.channel=0,this.wrapS=i,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=l,this.format=a,this.internalFormat=null,this.type=c,this.offset=new jt(0,0),this.repeat=new jt(1,1),this.center=new jt(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new oe,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(t&&t.depth&&t.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(hf).x}get height(){return this.source.getSize(hf).y}get depth(){return this.source.getSize(hf).z}get image(){return this.source.data}set image(t){this.source.data=t}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(t){return this.name=t.name,this.source=t.source,this.mipmaps=t.mipmaps.slice(0),this.mapping=t.mapping,this.channel=t.channel,this.wrapS=t.wrapS,this.wrapT=t.wrapT,this.magFilter=t.magFilter,this.minFilter=t.minFilter,this.anisotropy=t.anisotropy,this.format=t.format,this.internalFormat=t.internalFormat,this.type=t.type,this.normalized=t.normalized,this.offset.copy(t.offset),this.repeat.copy(t.repeat),this.center.copy(t.center),this.rotation=t.rotation,this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrix.copy(t.matrix),this.generateMipmaps=t.generateMipmaps,this.mipmapsAutoUpdate=t.mipmapsAutoUpdate,this.premultiplyAlpha=t.premultiplyAlpha,this.flipY=t.flipY,this.unpackAlignment=t.unpackAlignment,this.colorSpace=t.colorSpace,this.renderTarget=t.renderTarget,this.isRenderTargetTexture=t.isRenderTargetTexture,this.isPMREMTexture=t.isPMREMTexture,this.isArrayTexture=t.isArrayTexture,this.userData=JSON.parse(JSON.stringify(t.userData)),this.needsUpdate=!0,this}setValues(t){for(let e in t){let i=t[e];if(i===void 0){Kt(`Texture.setValues(): parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Kt(`Texture.setValues(): property '${e}' does not exist.`);continue}s&&i&&s.isVector2&&i.isVector2||s&&i&&s.isVector3&&i.isVector3||s&&i&&s.isMatrix3&&i.isMatrix3?s.copy(i):this[e]=i}}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.textures[this.uuid]!==void 0)return t.textures[this.uuid];let i={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(t).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(i.userData=this.userData),e||(t.textures[this.uuid]=i),i}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(t){if(this.mapping!==Yf)return t;if(t.applyMatrix3(this.matrix),t.x<0||t.x>1)switch(this.wrapS){case vc:t.x=t.x-Math.floor(t.x);break;case as:t.x=t.x<0?0:1;break;case Sc:Math.abs(Math.floor(t.x)%2)===1?t.x=Math.ceil(t.x)-t.x:t.x=t.x-Math.floor(t.x);break}if(t.y<0||t.y>1)switch(this.wrapT){case vc:t.y=t.y-Math.floor(t.y);break;case as:t.y=t.y<0?0:1;break;case Sc:Math.abs(Math.floor(t.y)%2)===1?t.y=Math.ceil(t.y)-t.y:t.y=t.y-Math.floor(t.y);break}return this.flipY&&(t.y=1-t.y),t}set needsUpdate(t){t===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(t){t===!0&&this.pmremVersion++}};ci.DEFAULT_IMAGE=null;ci.DEFAULT_MAPPING=Yf;ci.DEFAULT_ANISOTROPY=1;var Je=class{static{this.prototype.isVector4=!0}constructor(t=0,e=0,i=0,s=1){this.x=t,this.y=e,this.z=i,this.w=s}get width(){return this.z}set width(t){this.z=t}get height(){return this.w}set height(t){this.w=t}set(t,e,i,s){return this.x=t,this.y=e,this.z=i,this.w=s,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this.w=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setW(t){return this.w=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;case 3:this.w=e;break;default:throw new Error("THREE.Vector4: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this.w=t.w!==void 0?t.w:1,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this.w+=t.w,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this.w+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this.w=t.w+e.w,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this.w+=t.w*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this.w-=t.w,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this.w-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this.w=t.w-e.w,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this.w*=t.w,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this.w*=t,this}applyMatrix4(t){let e=this.x,i=this.y,s=this.z,r=this.w,o=t.elements;return this.x=o[0]*e+o[4]*i+o[8]*s+o[12]*r,this.y=o[1]*e+o[5]*i+o[9]*s+o[13]*r,this.z=o[2]*e+o[6]*i+o[10]*s+o[14]*r,this.w=o[3]*e+o[7]*i+o[11]*s+o[15]*r,this}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this.w/=t.w,this}divideScalar(t){return this.multiplyScalar(1/t)}setAxisAngleFromQuaternion(t){this.w=2*Math.acos(t.w);let e=Math.sqrt(1-t.w*t.w);return e<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=t.x/e,this.y=t.y/e,this.z=t.z/e),this}setAxisAngleFromRotationMatrix(t){let e,i,s,r,c=t.elements,l=c[0],h=c[4],f=c[8],u=c[1],d=c[5],p=c[9],_=c[2],m=c[6],g=c[10];if(Math.abs(h-u)<.01&&Math.abs(f-_)<.01&&Math.abs(p-m)<.01){if(Math.abs(h+u)<.1&&Math.abs(f+_)<.1&&Math.abs(p+m)<.1&&Math.abs(l+d+g-3)<.1)return this.set(1,0,0,0),this;e=Math.PI;let T=(l+1)/2,S=(d+1)/2,C=(g+1)/2,E=(h+u)/4,y=(f+_)/4,w=(p+m)/4;return T>S&&T>C?T<.01?(i=0,s=.707106781,r=.707106781):(i=Math.sqrt(T),s=E/i,r=y/i):S>C?S<.01?(i=.707106781,s=0,r=.707106781):(s=Math.sqrt(S),i=E/s,r=w/s):C<.01?(i=.707106781,s=.707106781,r=0):(r=Math.sqrt(C),i=y/r,s=w/r),this.set(i,s,r,e),this}let v=Math.sqrt((m-p)*(m-p)+(f-_)*(f-_)+(u-h)*(u-h));return Math.abs(v)<.001&&(v=1),this.x=(m-p)/v,this.y=(f-_)/v,this.z=(u-h)/v,this.w=Math.acos((l+d+g-1)/2),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this.w=e[15],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this.w=Math.min(this.w,t.w),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this.w=Math.max(this.w,t.w),this}clamp(t,e){return this.x=me(this.x,t.x,e.x),this.y=me(this.y,t.y,e.y),this.z=me(this.z,t.z,e.z),this.w=me(this.w,t.w,e.w),this}clampScalar(t,e){return this.x=me(this.x,t,e),this.y=me(this.y,t,e),this.z=me(this.z,t,e),this.w=me(this.w,t,e),this}clampLength(t,e){let i=this.length();return this.divideScalar(i||1).multiplyScalar(me(i,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z+this.w*t.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this.w+=(t.w-this.w)*e,this}lerpVectors(t,e,i){return this.x=t.x+(e.x-t.x)*i,this.y=t.y+(e.y-t.y)*i,this.z=t.z+(e.z-t.z)*i,this.w=t.w+(e.w-t.w)*i,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z&&t.w===this.w}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this.w=t[e+3],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t[e+3]=this.w,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this.w=t.getW(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},Mc=class extends Vi{constructor(t=1,e=1,i={}){super(),i=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:Bn,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},i),this.isRenderTarget=!0,this.width=t,this.height=e,this.depth=i.depth,this.scissor=new Je(0,0,t,e),this.scissorTest=!1,this.viewport=new Je(0,0,t,e),this.textures=[];let s=i.count;for(let r=0;r<s;r++)this.textures[r]=new ci({width:t,height:e,depth:i.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(i),this.depthBuffer=i.depthBuffer,this.stencilBuffer=i.stencilBuffer,this.resolveColorBuffer=i.resolveColorBuffer,this.resolveDepthBuffer=i.resolveDepthBuffer,this.resolveStencilBuffer=i.resolveStencilBuffer,this.storeMultisampledColorBuffer=i.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=i.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=i.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=i.depthTexture,this.samples=i.samples,this.multiview=i.multiview,this.useArrayDepthTexture=i.useArrayDepthTexture}_setTextureOptions(t={}){let e={minFilter:Bn,generateMipmaps:!1,flipY:!1,internalFormat:null};t.mapping!==void 0&&(e.mapping=t.mapping),t.wrapS!==void 0&&(e.wrapS=t.wrapS),t.wrapT!==void 0&&(e.wrapT=t.wrapT),t.wrapR!==void 0&&(e.wrapR=t.wrapR),t.magFilter!==void 0&&(e.magFilter=t.magFilter),t.minFilter!==void 0&&(e.minFilter=t.minFilter),t.format!==void 0&&(e.format=t.format),t.type!==void 0&&(e.type=t.type),t.anisotropy!==void 0&&(e.anisotropy=t.anisotropy),t.colorSpace!==void 0&&(e.colorSpace=t.colorSpace),t.flipY!==void 0&&(e.flipY=t.flipY),t.generateMipmaps!==void 0&&(e.generateMipmaps=t.generateMipmaps),t.mipmapsAutoUpdate!==void 0&&(e.mipmapsAutoUpdate=t.mipmapsAutoUpdate),t.internalFormat!==void 0&&(e.internalFormat=t.internalFormat);for(let i=0;i<this.textures.length;i++)this.textures[i].setValues(e)}get texture(){return this.textures[0]}set texture(t){this.textures[0]=t}set depthTexture(t){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),t!==null&&t.renderTarget===null&&(t.renderTarget=this),this._depthTexture=t}get depthTexture(){return this._depthTexture}setSize(t,e,i=1){if(this.width!==t||this.height!==e||this.depth!==i){this.width=t,this.height=e,this.depth=i;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=t,this.textures[s].image.height=e,this.textures[s].image.depth=i,this.textures[s].isData3DTexture!==!0&&(this.textures[s].isArrayTexture=this.textures[s].image.depth>1);this.dispose()}this.viewport.set(0,0,t,e),this.scissor.set(0,0,t,e)}clone(){return new this.constructor().copy(this)}copy(t){this.width=t.width,this.height=t.height,this.depth=t.depth,this.scissor.copy(t.scissor),this.scissorTest=t.scissorTest,this.viewport.copy(t.viewport),this.textures.length=0;for(let e=0,i=t.textures.length;e<i;e++){this.textures[e]=t.textures[e].clone(),this.textures[e].isRenderTargetTexture=!0,this.textures[e].renderTarget=this;let s=Object.assign({},t.textures[e].image);this.textures[e].source=new po(s)}if(this.depthBuffer=t.depthBuffer,this.stencilBuffer=t.stencilBuffer,this.resolveColorBuffer=t.resolveColorBuffer,this.resolveDepthBuffer=t.resolveDepthBuffer,this.resolveStencilBuffer=t.resolveStencilBuffer,this.storeMultisampledColorBuffer=t.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=t.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=t.storeMultisampledStencilBuffer,t.depthTexture!==null)if(t.depthTexture.renderTarget===t){let e=t.depthTexture.clone();e.renderTarget=null,this.depthTexture=e}else this.depthTexture=t.depthTexture;else this.depthTexture=null;return this.samples=t.samples,this.multiview=t.multiview,this.useArrayDepthTexture=t.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}},vi=class extends Mc{constructor(t=1,e=1,i={}){super(t,e,i),this.isWebGLRenderTarget=!0}},Ea=class extends ci{constructor(t=null,e=1,i=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:t,width:e,height:i,depth:s},this.magFilter=Nn,this.minFilter=Nn,this.wrapR=as,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}addLayerUpdate(t){this.layerUpdates.add(t)}clearLayerUpdates(){this.layerUpdates.clear()}};var Ec=class extends ci{constructor(t=null,e=1,i=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:t,width:e,height:i,depth:s},this.magFilter=Nn,this.minFilter=Nn,this.wrapR=as,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}};var Be=class n{static{this.prototype.isMatrix4=!0}constructor(t,e,i,s,r,o,a,c,l,h,f,u,d,p,_,m){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],t!==void 0&&this.set(t,e,i,s,r,o,a,c,l,h,f,u,d,p,_,m)}set(t,e,i,s,r,o,a,c,l,h,f,u,d,p,_,m){let g=this.elements;return g[0]=t,g[4]=e,g[8]=i,g[12]=s,g[1]=r,g[5]=o,g[9]=a,g[13]=c,g[2]=l,g[6]=h,g[10]=f,g[14]=u,g[3]=d,g[7]=p,g[11]=_,g[15]=m,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new n().fromArray(this.elements)}copy(t){let e=this.elements,i=t.elements;return e[0]=i[0],e[1]=i[1],e[2]=i[2],e[3]=i[3],e[4]=i[4],e[5]=i[5],e[6]=i[6],e[7]=i[7],e[8]=i[8],e[9]=i[9],e[10]=i[10],e[11]=i[11],e[12]=i[12],e[13]=i[13],e[14]=i[14],e[15]=i[15],this}copyPosition(t){let e=this.elements,i=t.elements;return e[12]=i[12],e[13]=i[13],e[14]=i[14],this}setFromMatrix3(t){let e=t.elements;return this.set(e[0],e[3],e[6],0,e[1],e[4],e[7],0,e[2],e[5],e[8],0,0,0,0,1),this}extractBasis(t,e,i){return this.determinantAffine()===0?(t.set(1,0,0),e.set(0,1,0),i.set(0,0,1),this):(t.setFromMatrixColumn(this,0),e.setFromMatrixColumn(this,1),i.setFromMatrixColumn(this,2),this)}makeBasis(t,e,i){return this.set(t.x,e.x,i.x,0,t.y,e.y,i.y,0,t.z,e.z,i.z,0,0,0,0,1),this}extractRotation(t){if(t.determinantAffine()===0)return this.identity();let e=this.elements,i=t.elements,s=1/Kr.setFromMatrixColumn(t,0).length(),r=1/Kr.setFromMatrixColumn(t,1).length(),o=1/Kr.setFromMatrixColumn(t,2).length();return e[0]=i[0]*s,e[1]=i[1]*s,e[2]=i[2]*s,e[3]=0,e[4]=i[4]*r,e[5]=i[5]*r,e[6]=i[6]*r,e[7]=0,e[8]=i[8]*o,e[9]=i[9]*o,e[10]=i[10]*o,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromEuler(t){let e=this.elements,i=t.x,s=t.y,r=t.z,o=Math.cos(i),a=Math.sin(i),c=Math.cos(s),l=Math.sin(s),h=Math.cos(r),f=Math.sin(r);if(t.order==="XYZ"){let u=o*h,d=o*f,p=a*h,_=a*f;e[0]=c*h,e[4]=-c*f,e[8]=l,e[1]=d+p*l,e[5]=u-_*l,e[9]=-a*c,e[2]=_-u*l,e[6]=p+d*l,e[10]=o*c}else if(t.order==="YXZ"){let u=c*h,d=c*f,p=l*h,_=l*f;e[0]=u+_*a,e[4]=p*a-d,e[8]=o*l,e[1]=o*f,e[5]=o*h,e[9]=-a,e[2]=d*a-p,e[6]=_+u*a,e[10]=o*c}else if(t.order==="ZXY"){let u=c*h,d=c*f,p=l*h,_=l*f;e[0]=u-_*a,e[4]=-o*f,e[8]=p+d*a,e[1]=d+p*a,e[5]=o*h,e[9]=_-u*a,e[2]=-o*l,e[6]=a,e[10]=o*c}else if(t.order==="ZYX"){let u=o*h,d=o*f,p=a*h,_=a*f;e[0]=c*h,e[4]=p*l-d,e[8]=u*l+_,e[1]=c*f,e[5]=_*l+u,e[9]=d*l-p,e[2]=-l,e[6]=a*c,e[10]=o*c}else if(t.order==="YZX"){let u=o*c,d=o*l,p=a*c,_=a*l;e[0]=c*h,e[4]=_-u*f,e[8]=p*f+d,e[1]=f,e[5]=o*h,e[9]=-a*h,e[2]=-l*h,e[6]=d*f+p,e[10]=u-_*f}else if(t.order==="XZY"){let u=o*c,d=o*l,p=a*c,_=a*l;e[0]=c*h,e[4]=-f,e[8]=l*h,e[1]=u*f+_,e[5]=o*h,e[9]=d*f-p,e[2]=p*f-d,e[6]=a*h,e[10]=_*f+u}return e[3]=0,e[7]=0,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromQuaternion(t){return this.compose(RS,t,IS)}lookAt(t,e,i){let s=this.elements;return gi.subVectors(t,e),gi.lengthSq()===0&&(gi.z=1),gi.normalize(),qs.crossVectors(i,gi),qs.lengthSq()===0&&(Math.abs(i.z)===1?gi.x+=1e-4:gi.z+=1e-4,gi.normalize(),qs.crossVectors(i,gi)),qs.normalize(),Gl.crossVectors(gi,qs),s[0]=qs.x,s[4]=Gl.x,s[8]=gi.x,s[1]=qs.y,s[5]=Gl.y,s[9]=gi.y,s[2]=qs.z,s[6]=Gl.z,s[10]=gi.z,this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let i=t.elements,s=e.elements,r=this.elements,o=i[0],a=i[4],c=i[8],l=i[12],h=i[1],f=i[5],u=i[9],d=i[13],p=i[2],_=i[6],m=i[10],g=i[14],v=i[3],T=i[7],S=i[11],C=i[15],E=s[0],y=s[4],w=s[8],V=s[12],N=s[1],L=s[5],B=s[9],F=s[13],R=s[2],U=s[6],X=s[10],G=s[14],ct=s[3],I=s[7],k=s[11],Y=s[15];return r[0]=o*E+a*N+c*R+l*ct,r[4]=o*y+a*L+c*U+l*I,r[8]=o*w+a*B+c*X+l*k,r[12]=o*V+a*F+c*G+l*Y,r[1]=h*E+f*N+u*R+d*ct,r[5]=h*y+f*L+u*U+d*I,r[9]=h*w+f*B+u*X+d*k,r[13]=h*V+f*F+u*G+d*Y,r[2]=p*E+_*N+m*R+g*ct,r[6]=p*y+_*L+m*U+g*I,r[10]=p*w+_*B+m*X+g*k,r[14]=p*V+_*F+m*G+g*Y,r[3]=v*E+T*N+S*R+C*ct,r[7]=v*y+T*L+S*U+C*I,r[11]=v*w+T*B+S*X+C*k,r[15]=v*V+T*F+S*G+C*Y,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[4]*=t,e[8]*=t,e[12]*=t,e[1]*=t,e[5]*=t,e[9]*=t,e[13]*=t,e[2]*=t,e[6]*=t,e[10]*=t,e[14]*=t,e[3]*=t,e[7]*=t,e[11]*=t,e[15]*=t,this}determinant(){let t=this.elements,e=t[0],i=t[4],s=t[8],r=t[12],o=t[1],a=t[5],c=t[9],l=t[13],h=t[2],f=t[6],u=t[10],d=t[14],p=t[3],_=t[7],m=t[11],g=t[15],v=c*d-l*u,T=a*d-l*f,S=a*u-c*f,C=o*d-l*h,E=o*u-c*h,y=o*f-a*h;return e*(_*v-m*T+g*S)-i*(p*v-m*C+g*E)+s*(p*T-_*C+g*y)-r*(p*S-_*E+m*y)}determinantAffine(){let t=this.elements,e=t[0],i=t[4],s=t[8],r=t[1],o=t[5],a=t[9],c=t[2],l=t[6],h=t[10];return e*(o*h-a*l)-i*(r*h-a*c)+s*(r*l-o*c)}transpose(){let t=this.elements,e;return e=t[1],t[1]=t[4],t[4]=e,e=t[2],t[2]=t[8],t[8]=e,e=t[6],t[6]=t[9],t[9]=e,e=t[3],t[3]=t[12],t[12]=e,e=t[7],t[7]=t[13],t[13]=e,e=t[11],t[11]=t[14],t[14]=e,this}setPosition(t,e,i){let s=this.elements;return t.isVector3?(s[12]=t.x,s[13]=t.y,s[14]=t.z):(s[12]=t,s[13]=e,s[14]=i),this}invert(){let t=this.elements,e=t[0],i=t[1],s=t[2],r=t[3],o=t[4],a=t[5],c=t[6],l=t[7],h=t[8],f=t[9],u=t[10],d=t[11],p=t[12],_=t[13],m=t[14],g=t[15],v=e*a-i*o,T=e*c-s*o,S=e*l-r*o,C=i*c-s*a,E=i*l-r*a,y=s*l-r*c,w=h*_-f*p,V=h*m-u*p,N=h*g-d*p,L=f*m-u*_,B=f*g-d*_,F=u*g-d*m,R=v*F-T*B+S*L+C*N-E*V+y*w;if(R===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let U=1/R;return t[0]=(a*F-c*B+l*L)*U,t[1]=(s*B-i*F-r*L)*U,t[2]=(_*y-m*E+g*C)*U,t[3]=(u*E-f*y-d*C)*U,t[4]=(c*N-o*F-l*V)*U,t[5]=(e*F-s*N+r*V)*U,t[6]=(m*S-p*y-g*T)*U,t[7]=(h*y-u*S+d*T)*U,t[8]=(o*B-a*N+l*w)*U,t[9]=(i*N-e*B-r*w)*U,t[10]=(p*E-_*S+g*v)*U,t[11]=(f*S-h*E-d*v)*U,t[12]=(a*V-o*L-c*w)*U,t[13]=(e*L-i*V+s*w)*U,t[14]=(_*T-p*C-m*v)*U,t[15]=(h*C-f*T+u*v)*U,this}scale(t){let e=this.elements,i=t.x,s=t.y,r=t.z;return e[0]*=i,e[4]*=s,e[8]*=r,e[1]*=i,e[5]*=s,e[9]*=r,e[2]*=i,e[6]*=s,e[10]*=r,e[3]*=i,e[7]*=s,e[11]*=r,this}getMaxScaleOnAxis(){let t=this.elements,e=t[0]*t[0]+t[1]*t[1]+t[2]*t[2],i=t[4]*t[4]+t[5]*t[5]+t[6]*t[6],s=t[8]*t[8]+t[9]*t[9]+t[10]*t[10];return Math.sqrt(Math.max(e,i,s))}makeTranslation(t,e,i){return t.isVector3?this.set(1,0,0,t.x,0,1,0,t.y,0,0,1,t.z,0,0,0,1):this.set(1,0,0,t,0,1,0,e,0,0,1,i,0,0,0,1),this}makeRotationX(t){let e=Math.cos(t),i=Math.sin(t);return this.set(1,0,0,0,0,e,-i,0,0,i,e,0,0,0,0,1),this}makeRotationY(t){let e=Math.cos(t),i=Math.sin(t);return this.set(e,0,i,0,0,1,0,0,-i,0,e,0,0,0,0,1),this}makeRotationZ(t){let e=Math.cos(t),i=Math.sin(t);return this.set(e,-i,0,0,i,e,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(t,e){let i=Math.cos(e),s=Math.sin(e),r=1-i,o=t.x,a=t.y,c=t.z,l=r*o,h=r*a;return this.set(l*o+i,l*a-s*c,l*c+s*a,0,l*a+s*c,h*a+i,h*c-s*o,0,l*c-s*a,h*c+s*o,r*c*c+i,0,0,0,0,1),this}makeScale(t,e,i){return this.set(t,0,0,0,0,e,0,0,0,0,i,0,0,0,0,1),this}makeShear(t,e,i,s,r,o){return this.set(1,i,r,0,t,1,o,0,e,s,1,0,0,0,0,1),this}compose(t,e,i){let s=this.elements,r=e._x,o=e._y,a=e._z,c=e._w,l=r+r,h=o+o,f=a+a,u=r*l,d=r*h,p=r*f,_=o*h,m=o*f,g=a*f,v=c*l,T=c*h,S=c*f,C=i.x,E=i.y,y=i.z;return s[0]=(1-(_+g))*C,s[1]=(d+S)*C,s[2]=(p-T)*C,s[3]=0,s[4]=(d-S)*E,s[5]=(1-(u+g))*E,s[6]=(m+v)*E,s[7]=0,s[8]=(p+T)*y,s[9]=(m-v)*y,s[10]=(1-(u+_))*y,s[11]=0,s[12]=t.x,s[13]=t.y,s[14]=t.z,s[15]=1,this}decompose(t,e,i){let s=this.elements;t.x=s[12],t.y=s[13],t.z=s[14];let r=this.determinantAffine();if(r===0)return i.set(1,1,1),e.identity(),this;let o=Kr.set(s[0],s[1],s[2]).length(),a=Kr.set(s[4],s[5],s[6]).length(),c=Kr.set(s[8],s[9],s[10]).length();r<0&&(o=-o),ki.copy(this);let l=1/o,h=1/a,f=1/c;return ki.elements[0]*=l,ki.elements[1]*=l,ki.elements[2]*=l,ki.elements[4]*=h,ki.elements[5]*=h,ki.elements[6]*=h,ki.elements[8]*=f,ki.elements[9]*=f,ki.elements[10]*=f,e.setFromRotationMatrix(ki),i.x=o,i.y=a,i.z=c,this}makePerspective(t,e,i,s,r,o,a=Ii,c=!1){let l=this.elements,h=2*r/(e-t),f=2*r/(i-s),u=(e+t)/(e-t),d=(i+s)/(i-s),p,_;if(c)p=r/(o-r),_=o*r/(o-r);else if(a===Ii)p=-(o+r)/(o-r),_=-2*o*r/(o-r);else if(a===ho)p=-o/(o-r),_=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return l[0]=h,l[4]=0,l[8]=u,l[12]=0,l[1]=0,l[5]=f,l[9]=d,l[13]=0,l[2]=0,l[6]=0,l[10]=p,l[14]=_,l[3]=0,l[7]=0,l[11]=-1,l[15]=0,this}makeOrthographic(t,e,i,s,r,o,a=Ii,c=!1){let l=this.elements,h=2/(e-t),f=2/(i-s),u=-(e+t)/(e-t),d=-(i+s)/(i-s),p,_;if(c)p=1/(o-r),_=o/(o-r);else if(a===Ii)p=-2/(o-r),_=-(o+r)/(o-r);else if(a===ho)p=-1/(o-r),_=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return l[0]=h,l[4]=0,l[8]=0,l[12]=u,l[1]=0,l[5]=f,l[9]=0,l[13]=d,l[2]=0,l[6]=0,l[10]=p,l[14]=_,l[3]=0,l[7]=0,l[11]=0,l[15]=1,this}equals(t){let e=this.elements,i=t.elements;for(let s=0;s<16;s++)if(e[s]!==i[s])return!1;return!0}fromArray(t,e=0){for(let i=0;i<16;i++)this.elements[i]=t[i+e];return this}toArray(t=[],e=0){let i=this.elements;return t[e]=i[0],t[e+1]=i[1],t[e+2]=i[2],t[e+3]=i[3],t[e+4]=i[4],t[e+5]=i[5],t[e+6]=i[6],t[e+7]=i[7],t[e+8]=i[8],t[e+9]=i[9],t[e+10]=i[10],t[e+11]=i[11],t[e+12]=i[12],t[e+13]=i[13],t[e+14]=i[14],t[e+15]=i[15],t}},Kr=new $,ki=new Be,RS=new $(0,0,0),IS=new $(1,1,1),qs=new $,Gl=new $,gi=new $,Wm=new Be,$m=new kn,As=class n{constructor(t=0,e=0,i=0,s=n.DEFAULT_ORDER){this.isEuler=!0,this._x=t,this._y=e,this._z=i,this._order=s}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get order(){return this._order}set order(t){this._order=t,this._onChangeCallback()}set(t,e,i,s=this._order){return this._x=t,this._y=e,this._z=i,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(t){return this._x=t._x,this._y=t._y,this._z=t._z,this._order=t._order,this._onChangeCallback(),this}setFromRotationMatrix(t,e=this._order,i=!0){let s=t.elements,r=s[0],o=s[4],a=s[8],c=s[1],l=s[5],h=s[9],f=s[2],u=s[6],d=s[10];switch(e){case"XYZ":this._y=Math.asin(me(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,d),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(u,l),this._z=0);break;case"YXZ":this._x=Math.asin(-me(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,d),this._z=Math.atan2(c,l)):(this._y=Math.atan2(-f,r),this._z=0);break;case"ZXY":this._x=Math.asin(me(u,-1,1)),Math.abs(u)<.9999999?(this._y=Math.atan2(-f,d),this._z=Math.atan2(-o,l)):(this._y=0,this._z=Math.atan2(c,r));break;case"ZYX":this._y=Math.asin(-me(f,-1,1)),Math.abs(f)<.9999999?(this._x=Math.atan2(u,d),this._z=Math.atan2(c,r)):(this._x=0,this._z=Math.atan2(-o,l));break;case"YZX":this._z=Math.asin(me(c,-1,1)),Math.abs(c)<.9999999?(this._x=Math.atan2(-h,l),this._y=Math.atan2(-f,r)):(this._x=0,this._y=Math.atan2(a,d));break;case"XZY":this._z=Math.asin(-me(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(u,l),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,d),this._y=0);break;default:Kt("Euler: .setFromRotationMatrix() encountered an unknown order: "+e)}return this._order=e,i===!0&&this._onChangeCallback(),this}setFromQuaternion(t,e,i){return Wm.makeRotationFromQuaternion(t),this.setFromRotationMatrix(Wm,e,i)}setFromVector3(t,e=this._order){return this.set(t.x,t.y,t.z,e)}reorder(t){return $m.setFromEuler(this),this.setFromQuaternion($m,t)}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._order===this._order}fromArray(t){return this._x=t[0],this._y=t[1],this._z=t[2],t[3]!==void 0&&(this._order=t[3]),this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._order,t}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};As.DEFAULT_ORDER="XYZ";var Aa=class{constructor(){this.mask=1}set(t){this.mask=(1<<t|0)>>>0}enable(t){this.mask|=1<<t|0}enableAll(){this.mask=-1}toggle(t){this.mask^=1<<t|0}disable(t){this.mask&=~(1<<t|0)}disableAll(){this.mask=0}test(t){return(this.mask&t.mask)!==0}isEnabled(t){return(this.mask&(1<<t|0))!==0}},PS=0,Xm=new $,Jr=new kn,xs=new Be,Wl=new $,da=new $,LS=new $,DS=new kn,qm=new $(1,0,0),Ym=new $(0,1,0),Zm=new $(0,0,1),Km={type:"added"},NS={type:"removed"},jr={type:"childadded",child:null},uf={type:"childremoved",child:null},zn=class n extends Vi{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:PS++}),this.uuid=To(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=n.DEFAULT_UP.clone();let t=new $,e=new As,i=new kn,s=new $(1,1,1);function r(){i.setFromEuler(e,!1)}function o(){e.setFromQuaternion(i,void 0,!1)}e._onChange(r),i._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:t},rotation:{configurable:!0,enumerable:!0,value:e},quaternion:{configurable:!0,enumerable:!0,value:i},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new Be},normalMatrix:{value:new oe}}),this.matrix=new Be,this.matrixWorld=new Be,this.matrixAutoUpdate=n.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=n.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Aa,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(t){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(t),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(t){return this.quaternion.premultiply(t),this}setRotationFromAxisAngle(t,e){this.quaternion.setFromAxisAngle(t,e)}setRotationFromEuler(t){this.quaternion.setFromEuler(t,!0)}setRotationFromMatrix(t){this.quaternion.setFromRotationMatrix(t)}setRotationFromQuaternion(t){this.quaternion.copy(t)}rotateOnAxis(t,e){return Jr.setFromAxisAngle(t,e),this.quaternion.multiply(Jr),this}rotateOnWorldAxis(t,e){return Jr.setFromAxisAngle(t,e),this.quaternion.premultiply(Jr),this}rotateX(t){return this.rotateOnAxis(qm,t)}rotateY(t){return this.rotateOnAxis(Ym,t)}rotateZ(t){return this.rotateOnAxis(Zm,t)}translateOnAxis(t,e){return Xm.copy(t).applyQuaternion(this.quaternion),this.position.add(Xm.multiplyScalar(e)),this}translateX(t){return this.translateOnAxis(qm,t)}translateY(t){return this.translateOnAxis(Ym,t)}translateZ(t){return this.translateOnAxis(Zm,t)}localToWorld(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(this.matrixWorld)}worldToLocal(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(xs.copy(this.matrixWorld).invert())}lookAt(t,e,i){t.isVector3?Wl.copy(t):Wl.set(t,e,i);let s=this.parent;this.updateWorldMatrix(!0,!1),da.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?xs.lookAt(da,Wl,this.up):xs.lookAt(Wl,da,this.up),this.quaternion.setFromRotationMatrix(xs),s&&(xs.extractRotation(s.matrixWorld),Jr.setFromRotationMatrix(xs),this.quaternion.premultiply(Jr.invert()))}add(t){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.add(arguments[e]);return this}return t===this?(re("Object3D.add: object can't be added as a child of itself.",t),this):(t&&t.isObject3D?(t.removeFromParent(),t.parent=this,this.children.push(t),t.dispatchEvent(Km),jr.child=t,this.dispatchEvent(jr),jr.child=null):re("Object3D.add: object not an instance of THREE.Object3D.",t),this)}remove(t){if(arguments.length>1){for(let i=0;i<arguments.length;i++)this.remove(arguments[i]);return this}let e=this.children.indexOf(t);return e!==-1&&(t.parent=null,this.children.splice(e,1),t.dispatchEvent(NS),uf.child=t,this.dispatchEvent(uf),uf.child=null),this}removeFromParent(){let t=this.parent;return t!==null&&t.remove(this),this}clear(){return this.remove(...this.children)}attach(t){return this.updateWorldMatrix(!0,!1),xs.copy(this.matrixWorld).invert(),t.parent!==null&&(t.parent.updateWorldMatrix(!0,!1),xs.multiply(t.parent.matrixWorld)),t.applyMatrix4(xs),t.removeFromParent(),t.parent=this,this.children.push(t),t.updateWorldMatrix(!1,!0),t.dispatchEvent(Km),jr.child=t,this.dispatchEvent(jr),jr.child=null,this}getObjectById(t){return this.getObjectByProperty("id",t)}getObjectByName(t){return this.getObjectByProperty("name",t)}getObjectByProperty(t,e){if(this[t]===e)return this;for(let i=0,s=this.children.length;i<s;i++){let o=this.children[i].getObjectByProperty(t,e);if(o!==void 0)return o}}getObjectsByProperty(t,e,i=[]){this[t]===e&&i.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(t,e,i);return i}getWorldPosition(t){return this.updateWorldMatrix(!0,!1),t.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(da,t,LS),t}getWorldScale(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(da,DS,t),t}getWorldDirection(t){this.updateWorldMatrix(!0,!1);let e=this.matrixWorld.elements;return t.set(e[8],e[9],e[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(t){t(this);let e=this.children;for(let i=0,s=e.length;i<s;i++)e[i].traverse(t)}traverseVisible(t){if(this.visible===!1)return;t(this);let e=this.children;for(let i=0,s=e.length;i<s;i++)e[i].traverseVisible(t)}traverseAncestors(t){let e=this.parent;e!==null&&(t(e),e.traverseAncestors(t))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let t=this.pivot;if(t!==null){let e=t.x,i=t.y,s=t.z,r=this.matrix.elements;r[12]+=e-r[0]*e-r[4]*i-r[8]*s,r[13]+=i-r[1]*e-r[5]*i-r[9]*s,r[14]+=s-r[2]*e-r[6]*i-r[10]*s}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(t){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||t)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,t=!0);let e=this.children;for(let i=0,s=e.length;i<s;i++)e[i].updateMatrixWorld(t)}updateWorldMatrix(t,e,i=!1){let s=this.parent;if(t===!0&&s!==null&&s.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||i)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,i=!0),e===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,i)}}toJSON(t){let e=t===void 0||typeof t=="string",i={};e&&(t={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},i.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,s.name=this.name,s.castShadow=this.castShadow,s.receiveShadow=this.receiveShadow,s.visible=this.visible,s.frustumCulled=this.frustumCulled,s.renderOrder=this.renderOrder,s.static=this.static,s.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.pivot!==null&&(s.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(s.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(s.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),s.instanceInfo=this._instanceInfo.map(a=>({...a})),s.availableInstanceIds=this._availableInstanceIds.slice(),s.availableGeometryIds=this._availableGeometryIds.slice(),s.nextIndexStart=this._nextIndexStart,s.nextVertexStart=this._nextVertexStart,s.geometryCount=this._geometryCount,s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.matricesTexture=this._matricesTexture.toJSON(t),s.indirectTexture=this._indirectTexture.toJSON(t),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(t)),this.boundingSphere!==null&&(s.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(s.boundingBox=this.boundingBox.toJSON()));function r(a,c){return a[c.uuid]===void 0&&(a[c.uuid]=c.toJSON(t)),c.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(t).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(t).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(t.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let c=a.shapes;if(Array.isArray(c))for(let l=0,h=c.length;l<h;l++){let f=c[l];r(t.shapes,f)}else r(t.shapes,c)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(t.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let c=0,l=this.material.length;c<l;c++)a.push(r(t.materials,this.material[c]));s.material=a}else s.material=r(t.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(t).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let c=this.animations[a];s.animations.push(r(t.animations,c))}}if(e){let a=o(t.geometries),c=o(t.materials),l=o(t.textures),h=o(t.images),f=o(t.shapes),u=o(t.skeletons),d=o(t.animations),p=o(t.nodes);a.length>0&&(i.geometries=a),c.length>0&&(i.materials=c),l.length>0&&(i.textures=l),h.length>0&&(i.images=h),f.length>0&&(i.shapes=f),u.length>0&&(i.skeletons=u),d.length>0&&(i.animations=d),p.length>0&&(i.nodes=p)}return i.object=s,i;function o(a){let c=[];for(let l in a){let h=a[l];delete h.metadata,c.push(h)}return c}}clone(t){return new this.constructor().copy(this,t)}copy(t,e=!0){if(this.name=t.name,this.up.copy(t.up),this.position.copy(t.position),this.rotation.order=t.rotation.order,this.quaternion.copy(t.quaternion),this.scale.copy(t.scale),this.pivot=t.pivot!==null?t.pivot.clone():null,this.matrix.copy(t.matrix),this.matrixWorld.copy(t.matrixWorld),this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrixWorldAutoUpdate=t.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=t.matrixWorldNeedsUpdate,this.layers.mask=t.layers.mask,this.visible=t.visible,this.castShadow=t.castShadow,this.receiveShadow=t.receiveShadow,this.frustumCulled=t.frustumCulled,this.renderOrder=t.renderOrder,this.static=t.static,this.animations=t.animations.slice(),this.userData=JSON.parse(JSON.stringify(t.userData)),e===!0)for(let i=0;i<t.children.length;i++){let s=t.children[i];this.add(s.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};zn.DEFAULT_UP=new $(0,1,0);zn.DEFAULT_MATRIX_AUTO_UPDATE=!0;zn.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var ei=class extends zn{constructor(){super(),this.isGroup=!0,this.type="Group"}},OS={type:"move"},mo=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new ei,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new ei,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new $,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new $),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new ei,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new $,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new $,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(t){return this._targetRay!==null&&this._targetRay.dispatchEvent(t),this._grip!==null&&this._grip.dispatchEvent(t),this._hand!==null&&this._hand.dispatchEvent(t),this}connect(t){if(t&&t.hand){let e=this._hand;if(e)for(let i of t.hand.values())this._getHandJoint(e,i)}return this.dispatchEvent({type:"connected",data:t}),this}disconnect(t){return this.dispatchEvent({type:"disconnected",data:t}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(t,e,i){let s=null,r=null,o=null,a=this._targetRay,c=this._grip,l=this._hand;if(t&&e.session.visibilityState!=="visible-blurred"){if(l&&t.hand){o=!0;for(let _ of t.hand.values()){let m=e.getJointPose(_,i),g=this._getHandJoint(l,_);m!==null&&(g.matrix.fromArray(m.transform.matrix),g.matrix.decompose(g.position,g.quaternion,g.scale),g.matrixWorldNeedsUpdate=!0,g.jointRadius=m.radius),g.visible=m!==null}let h=l.joints["index-finger-tip"],f=l.joints["thumb-tip"],u=h.position.distanceTo(f.position),d=.02,p=.005;l.inputState.pinching&&u>d+p?(l.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:t.handedness,target:this})):!l.inputState.pinching&&u<=d-p&&(l.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:t.handedness,target:this}))}else c!==null&&t.gripSpace&&(r=e.getPose(t.gripSpace,i),r!==null&&(c.matrix.fromArray(r.transform.matrix),c.matrix.decompose(c.position,c.quaternion,c.scale),c.matrixWorldNeedsUpdate=!0,r.linearVelocity?(c.hasLinearVelocity=!0,c.linearVelocity.copy(r.linearVelocity)):c.hasLinearVelocity=!1,r.angularVelocity?(c.hasAngularVelocity=!0,c.angularVelocity.copy(r.angularVelocity)):c.hasAngularVelocity=!1,c.eventsEnabled&&c.dispatchEvent({type:"gripUpdated",data:t,target:this})));a!==null&&(s=e.getPose(t.targetRaySpace,i),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.quaternion,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(OS)))}return a!==null&&(a.visible=s!==null),c!==null&&(c.visible=r!==null),l!==null&&(l.visible=o!==null),this}_getHandJoint(t,e){if(t.joints[e.jointName]===void 0){let i=new ei;i.matrixAutoUpdate=!1,i.visible=!1,t.joints[e.jointName]=i,t.add(i)}return t.joints[e.jointName]}},jg={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Ys={h:0,s:0,l:0},$l={h:0,s:0,l:0};function ff(n,t,e){return e<0&&(e+=1),e>1&&(e-=1),e<1/6?n+(t-n)*6*e:e<1/2?t:e<2/3?n+(t-n)*6*(2/3-e):n}var ue=class{constructor(t,e,i){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(t,e,i)}set(t,e,i){if(e===void 0&&i===void 0){let s=t;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(t,e,i);return this}setScalar(t){return this.r=t,this.g=t,this.b=t,this}setHex(t,e=yi){return t=Math.floor(t),this.r=(t>>16&255)/255,this.g=(t>>8&255)/255,this.b=(t&255)/255,ye.colorSpaceToWorking(this,e),this}setRGB(t,e,i,s=ye.workingColorSpace){return this.r=t,this.g=e,this.b=i,ye.colorSpaceToWorking(this,s),this}setHSL(t,e,i,s=ye.workingColorSpace){if(t=ad(t,1),e=me(e,0,1),i=me(i,0,1),e===0)this.r=this.g=this.b=i;else{let r=i<=.5?i*(1+e):i+e-i*e,o=2*i-r;this.r=ff(o,r,t+1/3),this.g=ff(o,r,t),this.b=ff(o,r,t-1/3)}return ye.colorSpaceToWorking(this,s),this}setStyle(t,e=yi){function i(r){r!==void 0&&parseFloat(r)<1&&Kt("Color: Alpha component of "+t+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(t)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return i(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,e);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return i(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,e);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return i(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,e);break;default:Kt("Color: Unknown color model "+t)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(t)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,e);if(o===6)return this.setHex(parseInt(r,16),e);Kt("Color: Invalid hex color "+t)}else if(t&&t.length>0)return this.setColorName(t,e);return this}setColorName(t,e=yi){let i=jg[t.toLowerCase()];return i!==void 0?this.setHex(i,e):Kt("Color: Unknown color "+t),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(t){return this.r=t.r,this.g=t.g,this.b=t.b,this}copySRGBToLinear(t){return this.r=Ms(t.r),this.g=Ms(t.g),this.b=Ms(t.b),this}copyLinearToSRGB(t){return this.r=lo(t.r),this.g=lo(t.g),this.b=lo(t.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(t=yi){return ye.workingToColorSpace($n.copy(this),t),Math.round(me($n.r*255,0,255))*65536+Math.round(me($n.g*255,0,255))*256+Math.round(me($n.b*255,0,255))}getHexString(t=yi){return("000000"+this.getHex(t).toString(16)).slice(-6)}getHSL(t,e=ye.workingColorSpace){ye.workingToColorSpace($n.copy(this),e);let i=$n.r,s=$n.g,r=$n.b,o=Math.max(i,s,r),a=Math.min(i,s,r),c,l,h=(a+o)/2;if(a===o)c=0,l=0;else{let f=o-a;switch(l=h<=.5?f/(o+a):f/(2-o-a),o){case i:c=(s-r)/f+(s<r?6:0);break;case s:c=(r-i)/f+2;break;case r:c=(i-s)/f+4;break}c/=6}return t.h=c,t.s=l,t.l=h,t}getRGB(t,e=ye.workingColorSpace){return ye.workingToColorSpace($n.copy(this),e),t.r=$n.r,t.g=$n.g,t.b=$n.b,t}getStyle(t=yi){ye.workingToColorSpace($n.copy(this),t);let e=$n.r,i=$n.g,s=$n.b;return t!==yi?`color(${t} ${e.toFixed(3)} ${i.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(e*255)},${Math.round(i*255)},${Math.round(s*255)})`}offsetHSL(t,e,i){return this.getHSL(Ys),this.setHSL(Ys.h+t,Ys.s+e,Ys.l+i)}add(t){return this.r+=t.r,this.g+=t.g,this.b+=t.b,this}addColors(t,e){return this.r=t.r+e.r,this.g=t.g+e.g,this.b=t.b+e.b,this}addScalar(t){return this.r+=t,this.g+=t,this.b+=t,this}sub(t){return this.r=Math.max(0,this.r-t.r),this.g=Math.max(0,this.g-t.g),this.b=Math.max(0,this.b-t.b),this}multiply(t){return this.r*=t.r,this.g*=t.g,this.b*=t.b,this}multiplyScalar(t){return this.r*=t,this.g*=t,this.b*=t,this}lerp(t,e){return this.r+=(t.r-this.r)*e,this.g+=(t.g-this.g)*e,this.b+=(t.b-this.b)*e,this}lerpColors(t,e,i){return this.r=t.r+(e.r-t.r)*i,this.g=t.g+(e.g-t.g)*i,this.b=t.b+(e.b-t.b)*i,this}lerpHSL(t,e){this.getHSL(Ys),t.getHSL($l);let i=va(Ys.h,$l.h,e),s=va(Ys.s,$l.s,e),r=va(Ys.l,$l.l,e);return this.setHSL(i,s,r),this}setFromVector3(t){return this.r=t.x,this.g=t.y,this.b=t.z,this}applyMatrix3(t){let e=this.r,i=this.g,s=this.b,r=t.elements;return this.r=r[0]*e+r[3]*i+r[6]*s,this.g=r[1]*e+r[4]*i+r[7]*s,this.b=r[2]*e+r[5]*i+r[8]*s,this}equals(t){return t.r===this.r&&t.g===this.g&&t.b===this.b}fromArray(t,e=0){return this.r=t[e],this.g=t[e+1],this.b=t[e+2],this}toArray(t=[],e=0){return t[e]=this.r,t[e+1]=this.g,t[e+2]=this.b,t}fromBufferAttribute(t,e){return this.r=t.getX(e),this.g=t.getY(e),this.b=t.getZ(e),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},$n=new ue;ue.NAMES=jg;var Ta=class extends zn{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new As,this.environmentIntensity=1,this.environmentRotation=new As,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(t,e){return super.copy(t,e),this.background=t.background!==null?t.background.clone():null,this.environment=t.environment!==null?t.environment.clone():null,this.fog=t.fog!==null?t.fog.clone():null,this.backgroundBlurriness=t.backgroundBlurriness,this.backgroundIntensity=t.backgroundIntensity,this.backgroundRotation.copy(t.backgroundRotation),this.environmentIntensity=t.environmentIntensity,this.environmentRotation.copy(t.environmentRotation),this.overrideMaterial=t.overrideMaterial!==null?t.overrideMaterial.clone():null,this.matrixAutoUpdate=t.matrixAutoUpdate,this}toJSON(t){let e=super.toJSON(t);return this.fog!==null&&(e.object.fog=this.fog.toJSON()),e.object.backgroundBlurriness=this.backgroundBlurriness,e.object.backgroundIntensity=this.backgroundIntensity,e.object.backgroundRotation=this.backgroundRotation.toArray(),e.object.environmentIntensity=this.environmentIntensity,e.object.environmentRotation=this.environmentRotation.toArray(),e}},zi=new $,vs=new $,df=new $,Ss=new $,Qr=new $,to=new $,Jm=new $,pf=new $,mf=new $,gf=new $,_f=new Je,yf=new Je,xf=new Je,js=class n{constructor(t=new $,e=new $,i=new $){this.a=t,this.b=e,this.c=i}static getNormal(t,e,i,s){s.subVectors(i,e),zi.subVectors(t,e),s.cross(zi);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(t,e,i,s,r){zi.subVectors(s,e),vs.subVectors(i,e),df.subVectors(t,e);let o=zi.dot(zi),a=zi.dot(vs),c=zi.dot(df),l=vs.dot(vs),h=vs.dot(df),f=o*l-a*a;if(f===0)return r.set(0,0,0),null;let u=1/f,d=(l*c-a*h)*u,p=(o*h-a*c)*u;return r.set(1-d-p,p,d)}static containsPoint(t,e,i,s){return this.getBarycoord(t,e,i,s,Ss)===null?!1:Ss.x>=0&&Ss.y>=0&&Ss.x+Ss.y<=1}static getInterpolation(t,e,i,s,r,o,a,c){return this.getBarycoord(t,e,i,s,Ss)===null?(c.x=0,c.y=0,"z"in c&&(c.z=0),"w"in c&&(c.w=0),null):(c.setScalar(0),c.addScaledVector(r,Ss.x),c.addScaledVector(o,Ss.y),c.addScaledVector(a,Ss.z),c)}static getInterpolatedAttribute(t,e,i,s,r,o){return _f.setScalar(0),yf.setScalar(0),xf.setScalar(0),_f.fromBufferAttribute(t,e),yf.fromBufferAttribute(t,i),xf.fromBufferAttribute(t,s),o.setScalar(0),o.addScaledVector(_f,r.x),o.addScaledVector(yf,r.y),o.addScaledVector(xf,r.z),o}static isFrontFacing(t,e,i,s){return zi.subVectors(i,e),vs.subVectors(t,e),zi.cross(vs).dot(s)<0}set(t,e,i){return this.a.copy(t),this.b.copy(e),this.c.copy(i),this}setFromPointsAndIndices(t,e,i,s){return this.a.copy(t[e]),this.b.copy(t[i]),this.c.copy(t[s]),this}setFromAttributeAndIndices(t,e,i,s){return this.a.fromBufferAttribute(t,e),this.b.fromBufferAttribute(t,i),this.c.fromBufferAttribute(t,s),this}clone(){return new this.constructor().copy(this)}copy(t){return this.a.copy(t.a),this.b.copy(t.b),this.c.copy(t.c),this}getArea(){return zi.subVectors(this.c,this.b),vs.subVectors(this.a,this.b),zi.cross(vs).length()*.5}getMidpoint(t){return t.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(t){return n.getNormal(this.a,this.b,this.c,t)}getPlane(t){return t.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(t,e){return n.getBarycoord(t,this.a,this.b,this.c,e)}getInterpolation(t,e,i,s,r){return n.getInterpolation(t,this.a,this.b,this.c,e,i,s,r)}containsPoint(t){return n.containsPoint(t,this.a,this.b,this.c)}isFrontFacing(t){return n.isFrontFacing(this.a,this.b,this.c,t)}intersectsBox(t){return t.intersectsTriangle(this)}closestPointToPoint(t,e){let i=this.a,s=this.b,r=this.c,o,a;Qr.subVectors(s,i),to.subVectors(r,i),pf.subVectors(t,i);let c=Qr.dot(pf),l=to.dot(pf);if(c<=0&&l<=0)return e.copy(i);mf.subVectors(t,s);let h=Qr.dot(mf),f=to.dot(mf);if(h>=0&&f<=h)return e.copy(s);let u=c*f-h*l;if(u<=0&&c>=0&&h<=0&&c-h>0)return o=c/(c-h),e.copy(i).addScaledVector(Qr,o);gf.subVectors(t,r);let d=Qr.dot(gf),p=to.dot(gf);if(p>=0&&d<=p)return e.copy(r);let _=d*l-c*p;if(_<=0&&l>=0&&p<=0)return a=l/(l-p),e.copy(i).addScaledVector(to,a);let m=h*p-d*f;if(m<=0&&f-h>=0&&d-p>=0)return Jm.subVectors(r,s),a=(f-h)/(f-h+(d-p)),e.copy(s).addScaledVector(Jm,a);let g=1/(m+_+u);return o=_*g,a=u*g,e.copy(i).addScaledVector(Qr,o).addScaledVector(to,a)}equals(t){return t.a.equals(this.a)&&t.b.equals(this.b)&&t.c.equals(this.c)}},ls=class{constructor(t=new $(1/0,1/0,1/0),e=new $(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=t,this.max=e}set(t,e){return this.min.copy(t),this.max.copy(e),this}setFromArray(t){this.makeEmpty();for(let e=0,i=t.length;e<i;e+=3)this.expandByPoint(Hi.fromArray(t,e));return this}setFromBufferAttribute(t){this.makeEmpty();for(let e=0,i=t.count;e<i;e++)this.expandByPoint(Hi.fromBufferAttribute(t,e));return this}setFromPoints(t){this.makeEmpty();for(let e=0,i=t.length;e<i;e++)this.expandByPoint(t[e]);return this}setFromCenterAndSize(t,e){let i=Hi.copy(e).multiplyScalar(.5);return this.min.copy(t).sub(i),this.max.copy(t).add(i),this}setFromObject(t,e=!1){return this.makeEmpty(),this.expandByObject(t,e)}clone(){return new this.constructor().copy(this)}copy(t){return this.min.copy(t.min),this.max.copy(t.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(t){return this.isEmpty()?t.set(0,0,0):t.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(t){return this.isEmpty()?t.set(0,0,0):t.subVectors(this.max,this.min)}expandByPoint(t){return this.min.min(t),this.max.max(t),this}expandByVector(t){return this.min.sub(t),this.max.add(t),this}expandByScalar(t){return this.min.addScalar(-t),this.max.addScalar(t),this}expandByObject(t,e=!1){t.updateWorldMatrix(!1,!1);let i=t.geometry;if(i!==void 0){let r=i.getAttribute("position");if(e===!0&&r!==void 0&&t.isInstancedMesh!==!0&&t.isBatchedMesh!==!0)for(let o=0,a=r.count;o<a;o++)t.isMesh===!0?t.getVertexPosition(o,Hi):Hi.fromBufferAttribute(r,o),Hi.applyMatrix4(t.matrixWorld),this.expandByPoint(Hi);else t.boundingBox!==void 0?(t.boundingBox===null&&t.computeBoundingBox(),Xl.copy(t.boundingBox)):(i.boundingBox===null&&i.computeBoundingBox(),Xl.copy(i.boundingBox)),Xl.applyMatrix4(t.matrixWorld),this.union(Xl)}let s=t.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],e);return this}containsPoint(t){return t.x>=this.min.x&&t.x<=this.max.x&&t.y>=this.min.y&&t.y<=this.max.y&&t.z>=this.min.z&&t.z<=this.max.z}containsBox(t){return this.min.x<=t.min.x&&t.max.x<=this.max.x&&this.min.y<=t.min.y&&t.max.y<=this.max.y&&this.min.z<=t.min.z&&t.max.z<=this.max.z}getParameter(t,e){return e.set((t.x-this.min.x)/(this.max.x-this.min.x),(t.y-this.min.y)/(this.max.y-this.min.y),(t.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(t){return t.max.x>=this.min.x&&t.min.x<=this.max.x&&t.max.y>=this.min.y&&t.min.y<=this.max.y&&t.max.z>=this.min.z&&t.min.z<=this.max.z}intersectsSphere(t){return this.clampPoint(t.center,Hi),Hi.distanceToSquared(t.center)<=t.radius*t.radius}intersectsPlane(t){let e,i;return t.normal.x>0?(e=t.normal.x*this.min.x,i=t.normal.x*this.max.x):(e=t.normal.x*this.max.x,i=t.normal.x*this.min.x),t.normal.y>0?(e+=t.normal.y*this.min.y,i+=t.normal.y*this.max.y):(e+=t.normal.y*this.max.y,i+=t.normal.y*this.min.y),t.normal.z>0?(e+=t.normal.z*this.min.z,i+=t.normal.z*this.max.z):(e+=t.normal.z*this.max.z,i+=t.normal.z*this.min.z),e<=-t.constant&&i>=-t.constant}intersectsTriangle(t){if(this.isEmpty())return!1;this.getCenter(pa),ql.subVectors(this.max,pa),eo.subVectors(t.a,pa),no.subVectors(t.b,pa),io.subVectors(t.c,pa),Zs.subVectors(no,eo),Ks.subVectors(io,no),_r.subVectors(eo,io);let e=[0,-Zs.z,Zs.y,0,-Ks.z,Ks.y,0,-_r.z,_r.y,Zs.z,0,-Zs.x,Ks.z,0,-Ks.x,_r.z,0,-_r.x,-Zs.y,Zs.x,0,-Ks.y,Ks.x,0,-_r.y,_r.x,0];return!vf(e,eo,no,io,ql)||(e=[1,0,0,0,1,0,0,0,1],!vf(e,eo,no,io,ql))?!1:(Yl.crossVectors(Zs,Ks),e=[Yl.x,Yl.y,Yl.z],vf(e,eo,no,io,ql))}clampPoint(t,e){return e.copy(t).clamp(this.min,this.max)}distanceToPoint(t){return this.clampPoint(t,Hi).distanceTo(t)}getBoundingSphere(t){return this.isEmpty()?t.makeEmpty():(this.getCenter(t.center),t.radius=this.getSize(Hi).length()*.5),t}intersect(t){return this.min.max(t.min),this.max.min(t.max),this.isEmpty()&&this.makeEmpty(),this}union(t){return this.min.min(t.min),this.max.max(t.max),this}applyMatrix4(t){return this.isEmpty()?this:(bs[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(t),bs[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(t),bs[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(t),bs[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(t),bs[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(t),bs[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(t),bs[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(t),bs[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(t),this.setFromPoints(bs),this)}translate(t){return this.min.add(t),this.max.add(t),this}equals(t){return t.min.equals(this.min)&&t.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(t){return this.min.fromArray(t.min),this.max.fromArray(t.max),this}},bs=[new $,new $,new $,new $,new $,new $,new $,new $],Hi=new $,Xl=new ls,eo=new $,no=new $,io=new $,Zs=new $,Ks=new $,_r=new $,pa=new $,ql=new $,Yl=new $,yr=new $;function vf(n,t,e,i,s){for(let r=0,o=n.length-3;r<=o;r+=3){yr.fromArray(n,r);let a=s.x*Math.abs(yr.x)+s.y*Math.abs(yr.y)+s.z*Math.abs(yr.z),c=t.dot(yr),l=e.dot(yr),h=i.dot(yr);if(Math.max(-Math.max(c,l,h),Math.min(c,l,h))>a)return!1}return!0}var mn=new $,Zl=new jt,US=0,Xn=class extends Vi{constructor(t,e,i=!1){if(super(),Array.isArray(t))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:US++}),this.name="",this.array=t,this.itemSize=e,this.count=t!==void 0?t.length/e:0,this.normalized=i,this.usage=$g,this.updateRanges=[],this.gpuType=Wi,this.version=0,this._normalizationScale=t!==void 0?cd(t):void 0}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.name=t.name,this.array=new t.array.constructor(t.array),this.itemSize=t.itemSize,this.count=t.count,this.normalized=t.normalized,this.usage=t.usage,this.gpuType=t.gpuType,this._normalizationScale=t._normalizationScale,this}copyAt(t,e,i){t*=this.itemSize,i*=e.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[t+s]=e.array[i+s];return this}copyArray(t){return this.array.set(t),this}applyMatrix3(t){if(this.itemSize===2)for(let e=0,i=this.count;e<i;e++)Zl.fromBufferAttribute(this,e),Zl.applyMatrix3(t),this.setXY(e,Zl.x,Zl.y);else if(this.itemSize===3)for(let e=0,i=this.count;e<i;e++)mn.fromBufferAttribute(this,e),mn.applyMatrix3(t),this.setXYZ(e,mn.x,mn.y,mn.z);return this}applyMatrix4(t){for(let e=0,i=this.count;e<i;e++)mn.fromBufferAttribute(this,e),mn.applyMatrix4(t),this.setXYZ(e,mn.x,mn.y,mn.z);return this}applyNormalMatrix(t){for(let e=0,i=this.count;e<i;e++)mn.fromBufferAttribute(this,e),mn.applyNormalMatrix(t),this.setXYZ(e,mn.x,mn.y,mn.z);return this}transformDirection(t){for(let e=0,i=this.count;e<i;e++)mn.fromBufferAttribute(this,e),mn.transformDirection(t),this.setXYZ(e,mn.x,mn.y,mn.z);return this}set(t,e=0){return this.array.set(t,e),this}getComponent(t,e){let i=this.array[t*this.itemSize+e];return this.normalized&&(i=this._denormalize(i)),i}setComponent(t,e,i){return this.normalized&&(i=this._normalize(i)),this.array[t*this.itemSize+e]=i,this}getX(t){let e=this.array[t*this.itemSize];return this.normalized&&(e=this._denormalize(e)),e}setX(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize]=e,this}getY(t){let e=this.array[t*this.itemSize+1];return this.normalized&&(e=this._denormalize(e)),e}setY(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+1]=e,this}getZ(t){let e=this.array[t*this.itemSize+2];return this.normalized&&(e=this._denormalize(e)),e}setZ(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+2]=e,this}getW(t){let e=this.array[t*this.itemSize+3];return this.normalized&&(e=this._denormalize(e)),e}setW(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+3]=e,this}setXY(t,e,i){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),i=this._normalize(i)),this.array[t+0]=e,this.array[t+1]=i,this}setXYZ(t,e,i,s){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),i=this._normalize(i),s=this._normalize(s)),this.array[t+0]=e,this.array[t+1]=i,this.array[t+2]=s,this}setXYZW(t,e,i,s,r){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),i=this._normalize(i),s=this._normalize(s),r=this._normalize(r)),this.array[t+0]=e,this.array[t+1]=i,this.array[t+2]=s,this.array[t+3]=r,this}onUpload(t){return this.onUploadCallback=t,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let t={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return t.name=this.name,t.usage=this.usage,t.gpuType=this.gpuType,t}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(t){let e=this._normalizationScale;return e!==void 0?Math.max(t/e,-1):Kg(t,this.array)}_normalize(t){let e=this._normalizationScale;return e!==void 0?Math.round(t*e):Jg(t,this.array)}};var Ca=class extends Xn{constructor(t,e,i){super(new Uint16Array(t),e,i)}};var Ra=class extends Xn{constructor(t,e,i){super(new Uint32Array(t),e,i)}};var tn=class extends Xn{constructor(t,e,i){super(new Float32Array(t),e,i)}},FS=new ls,ma=new $,Sf=new $,Ts=class{constructor(t=new $,e=-1){this.isSphere=!0,this.center=t,this.radius=e}set(t,e){return this.center.copy(t),this.radius=e,this}setFromPoints(t,e){let i=this.center;e!==void 0?i.copy(e):FS.setFromPoints(t).getCenter(i);let s=0;for(let r=0,o=t.length;r<o;r++)s=Math.max(s,i.distanceToSquared(t[r]));return this.radius=Math.sqrt(s),this}copy(t){return this.center.copy(t.center),this.radius=t.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(t){return t.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(t){return t.distanceTo(this.center)-this.radius}intersectsSphere(t){let e=this.radius+t.radius;return t.center.distanceToSquared(this.center)<=e*e}intersectsBox(t){return t.intersectsSphere(this)}intersectsPlane(t){return Math.abs(t.distanceToPoint(this.center))<=this.radius}clampPoint(t,e){let i=this.center.distanceToSquared(t);return e.copy(t),i>this.radius*this.radius&&(e.sub(this.center).normalize(),e.multiplyScalar(this.radius).add(this.center)),e}getBoundingBox(t){return this.isEmpty()?(t.makeEmpty(),t):(t.set(this.center,this.center),t.expandByScalar(this.radius),t)}applyMatrix4(t){return this.center.applyMatrix4(t),this.radius=this.radius*t.getMaxScaleOnAxis(),this}translate(t){return this.center.add(t),this}expandByPoint(t){if(this.isEmpty())return this.center.copy(t),this.radius=0,this;ma.subVectors(t,this.center);let e=ma.lengthSq();if(e>this.radius*this.radius){let i=Math.sqrt(e),s=(i-this.radius)*.5;this.center.addScaledVector(ma,s/i),this.radius+=s}return this}union(t){return t.isEmpty()?this:this.isEmpty()?(this.copy(t),this):(this.center.equals(t.center)===!0?this.radius=Math.max(this.radius,t.radius):(Sf.subVectors(t.center,this.center).setLength(t.radius),this.expandByPoint(ma.copy(t.center).add(Sf)),this.expandByPoint(ma.copy(t.center).sub(Sf))),this)}equals(t){return t.center.equals(this.center)&&t.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(t){return this.radius=t.radius,this.center.fromArray(t.center),this}},BS=0,Ri=new Be,bf=new zn,so=new $,_i=new ls,ga=new ls,Dn=new $,Hn=class n extends Vi{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:BS++}),this.uuid=To(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(t){return Array.isArray(t)?this.index=new(cS(t)?Ra:Ca)(t,1):this.index=t,this}setIndirect(t,e=0){return this.indirect=t,this.indirectOffset=e,this}getIndirect(){return this.indirect}getAttribute(t){return this.attributes[t]}setAttribute(t,e){return this.attributes[t]=e,this}deleteAttribute(t){return delete this.attributes[t],this}hasAttribute(t){return this.attributes[t]!==void 0}addGroup(t,e,i=0){this.groups.push({start:t,count:e,materialIndex:i})}clearGroups(){this.groups=[]}setDrawRange(t,e){this.drawRange.start=t,this.drawRange.count=e}applyMatrix4(t){let e=this.attributes.position;e!==void 0&&(e.applyMatrix4(t),e.needsUpdate=!0);let i=this.attributes.normal;if(i!==void 0){let r=new oe().getNormalMatrix(t);i.applyNormalMatrix(r),i.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(t),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(t){return Ri.makeRotationFromQuaternion(t),this.applyMatrix4(Ri),this}rotateX(t){return Ri.makeRotationX(t),this.applyMatrix4(Ri),this}rotateY(t){return Ri.makeRotationY(t),this.applyMatrix4(Ri),this}rotateZ(t){return Ri.makeRotationZ(t),this.applyMatrix4(Ri),this}translate(t,e,i){return Ri.makeTranslation(t,e,i),this.applyMatrix4(Ri),this}scale(t,e,i){return Ri.makeScale(t,e,i),this.applyMatrix4(Ri),this}lookAt(t){return bf.lookAt(t),bf.updateMatrix(),this.applyMatrix4(bf.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(so).negate(),this.translate(so.x,so.y,so.z),this}setFromPoints(t){let e=this.getAttribute("position");if(e===void 0){let i=[];for(let s=0,r=t.length;s<r;s++){let o=t[s];i.push(o.x,o.y,o.z||0)}this.setAttribute("position",new tn(i,3))}else{let i=Math.min(t.length,e.count);for(let s=0;s<i;s++){let r=t[s];e.setXYZ(s,r.x,r.y,r.z||0)}t.length>e.count&&Kt("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),e.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new ls);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){re("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new $(-1/0,-1/0,-1/0),new $(1/0,1/0,1/0));return}if(t!==void 0){if(this.boundingBox.setFromBufferAttribute(t),e)for(let i=0,s=e.length;i<s;i++){let r=e[i];_i.setFromBufferAttribute(r),this.morphTargetsRelative?(Dn.addVectors(this.boundingBox.min,_i.min),this.boundingBox.expandByPoint(Dn),Dn.addVectors(this.boundingBox.max,_i.max),this.boundingBox.expandByPoint(Dn)):(this.boundingBox.expandByPoint(_i.min),this.boundingBox.expandByPoint(_i.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&re('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new Ts);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){re("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new $,1/0);return}if(t){let i=this.boundingSphere.center;if(_i.setFromBufferAttribute(t),e)for(let r=0,o=e.length;r<o;r++){let a=e[r];ga.setFromBufferAttribute(a),this.morphTargetsRelative?(Dn.addVectors(_i.min,ga.min),_i.expandByPoint(Dn),Dn.addVectors(_i.max,ga.max),_i.expandByPoint(Dn)):(_i.expandByPoint(ga.min),_i.expandByPoint(ga.max))}_i.getCenter(i);let s=0;for(let r=0,o=t.count;r<o;r++)Dn.fromBufferAttribute(t,r),s=Math.max(s,i.distanceToSquared(Dn));if(e)for(let r=0,o=e.length;r<o;r++){let a=e[r],c=this.morphTargetsRelative;for(let l=0,h=a.count;l<h;l++)Dn.fromBufferAttribute(a,l),c&&(so.fromBufferAttribute(t,l),Dn.add(so)),s=Math.max(s,i.distanceToSquared(Dn))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&re('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let t=this.index,e=this.attributes;if(t===null||e.position===void 0||e.normal===void 0||e.uv===void 0){re("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let i=e.position,s=e.normal,r=e.uv,o=this.getAttribute("tangent");(o===void 0||o.count!==i.count)&&(o=new Xn(new Float32Array(4*i.count),4),this.setAttribute("tangent",o));let a=[],c=[],l=new Uint8Array(i.count);for(let V=0;V<i.count;V++)a[V]=new $,c[V]=new $;let h=new $,f=new $,u=new $,d=new jt,p=new jt,_=new jt,m=new $,g=new $;function v(V,N,L){l[V]=l[N]=l[L]=1,h.fromBufferAttribute(i,V),f.fromBufferAttribute(i,N),u.fromBufferAttribute(i,L),d.fromBufferAttribute(r,V),p.fromBufferAttribute(r,N),_.fromBufferAttribute(r,L),f.sub(h),u.sub(h),p.sub(d),_.sub(d);let B=1/(p.x*_.y-_.x*p.y);isFinite(B)&&(m.copy(f).multiplyScalar(_.y).addScaledVector(u,-p.y).multiplyScalar(B),g.copy(u).multiplyScalar(p.x).addScaledVector(f,-_.x).multiplyScalar(B),a[V].add(m),a[N].add(m),a[L].add(m),c[V].add(g),c[N].add(g),c[L].add(g))}let T=this.groups;T.length===0&&(T=[{start:0,count:t.count}]);for(let V=0,N=T.length;V<N;++V){let L=T[V],B=L.start,F=L.count;for(let R=B,U=B+F;R<U;R+=3)v(t.getX(R+0),t.getX(R+1),t.getX(R+2))}let S=new $,C=new $,E=new $,y=new $;function w(V){E.fromBufferAttribute(s,V),y.copy(E);let N=a[V];S.copy(N),S.sub(E.multiplyScalar(E.dot(N))).normalize(),C.crossVectors(y,N);let B=C.dot(c[V])<0?-1:1;o.setXYZW(V,S.x,S.y,S.z,B)}for(let V=0,N=i.count;V<N;++V)l[V]&&w(V);this._transformed=!0}computeVertexNormals(){let t=this.index,e=this.getAttribute("position");if(e!==void 0){let i=this.getAttribute("normal");if(i===void 0||i.count!==e.count)i=new Xn(new Float32Array(e.count*3),3),this.setAttribute("normal",i);else for(let u=0,d=i.count;u<d;u++)i.setXYZ(u,0,0,0);let s=new $,r=new $,o=new $,a=new $,c=new $,l=new $,h=new $,f=new $;if(t)for(let u=0,d=t.count;u<d;u+=3){let p=t.getX(u+0),_=t.getX(u+1),m=t.getX(u+2);s.fromBufferAttribute(e,p),r.fromBufferAttribute(e,_),o.fromBufferAttribute(e,m),h.subVectors(o,r),f.subVectors(s,r),h.cross(f),a.fromBufferAttribute(i,p),c.fromBufferAttribute(i,_),l.fromBufferAttribute(i,m),a.add(h),c.add(h),l.add(h),i.setXYZ(p,a.x,a.y,a.z),i.setXYZ(_,c.x,c.y,c.z),i.setXYZ(m,l.x,l.y,l.z)}else for(let u=0,d=e.count;u<d;u+=3)s.fromBufferAttribute(e,u+0),r.fromBufferAttribute(e,u+1),o.fromBufferAttribute(e,u+2),h.subVectors(o,r),f.subVectors(s,r),h.cross(f),i.setXYZ(u+0,h.x,h.y,h.z),i.setXYZ(u+1,h.x,h.y,h.z),i.setXYZ(u+2,h.x,h.y,h.z);this.normalizeNormals(),i.needsUpdate=!0}}normalizeNormals(){let t=this.attributes.normal;for(let e=0,i=t.count;e<i;e++)Dn.fromBufferAttribute(t,e),Dn.normalize(),t.setXYZ(e,Dn.x,Dn.y,Dn.z)}toNonIndexed(){function t(a,c){let l=a.array,h=a.itemSize,f=a.normalized,u=new l.constructor(c.length*h),d=0,p=0;for(let _=0,m=c.length;_<m;_++){a.isInterleavedBufferAttribute?d=c[_]*a.data.stride+a.offset:d=c[_]*h;for(let g=0;g<h;g++)u[p++]=l[d++]}return new Xn(u,h,f)}if(this.index===null)return Kt("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let e=new n,i=this.index.array,s=this.attributes;for(let a in s){let c=s[a],l=t(c,i);e.setAttribute(a,l)}let r=this.morphAttributes;for(let a in r){let c=[],l=r[a];for(let h=0,f=l.length;h<f;h++){let u=l[h],d=t(u,i);c.push(d)}e.morphAttributes[a]=c}e.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,c=o.length;a<c;a++){let l=o[a];e.addGroup(l.start,l.count,l.materialIndex)}return e}toJSON(){let t={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(t.uuid=this.uuid,t.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,t.name=this.name,Object.keys(this.userData).length>0&&(t.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let c=this.parameters;for(let l in c)c[l]!==void 0&&(t[l]=c[l]);return t}t.data={attributes:{}};let e=this.index;e!==null&&(t.data.index={type:e.array.constructor.name,array:Array.prototype.slice.call(e.array)});let i=this.attributes;for(let c in i){let l=i[c];t.data.attributes[c]=l.toJSON(t.data)}let s={},r=!1;for(let c in this.morphAttributes){let l=this.morphAttributes[c],h=[];for(let f=0,u=l.length;f<u;f++){let d=l[f];h.push(d.toJSON(t.data))}h.length>0&&(s[c]=h,r=!0)}r&&(t.data.morphAttributes=s,t.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(t.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(t.data.boundingSphere=a.toJSON()),t}clone(){return new this.constructor().copy(this)}copy(t){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let e={};this.name=t.name;let i=t.index;i!==null&&this.setIndex(i.clone());let s=t.attributes;for(let l in s){let h=s[l];this.setAttribute(l,h.clone(e))}let r=t.morphAttributes;for(let l in r){let h=[],f=r[l];for(let u=0,d=f.length;u<d;u++)h.push(f[u].clone(e));this.morphAttributes[l]=h}this.morphTargetsRelative=t.morphTargetsRelative;let o=t.groups;for(let l=0,h=o.length;l<h;l++){let f=o[l];this.addGroup(f.start,f.count,f.materialIndex)}let a=t.boundingBox;a!==null&&(this.boundingBox=a.clone());let c=t.boundingSphere;return c!==null&&(this.boundingSphere=c.clone()),this.drawRange.start=t.drawRange.start,this.drawRange.count=t.drawRange.count,this.userData=t.userData,this._transformed=t._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}};var wf=new $,kS=new $,zS=new oe,xi=class{constructor(t=new $(1,0,0),e=0){this.isPlane=!0,this.normal=t,this.constant=e}set(t,e){return this.normal.copy(t),this.constant=e,this}setComponents(t,e,i,s){return this.normal.set(t,e,i),this.constant=s,this}setFromNormalAndCoplanarPoint(t,e){return this.normal.copy(t),this.constant=-e.dot(this.normal),this}setFromCoplanarPoints(t,e,i){let s=wf.subVectors(i,e).cross(kS.subVectors(t,e)).normalize();return this.setFromNormalAndCoplanarPoint(s,t),this}copy(t){return this.normal.copy(t.normal),this.constant=t.constant,this}normalize(){let t=1/this.normal.length();return this.normal.multiplyScalar(t),this.constant*=t,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(t){return this.normal.dot(t)+this.constant}distanceToSphere(t){return this.distanceToPoint(t.center)-t.radius}projectPoint(t,e){return e.copy(t).addScaledVector(this.normal,-this.distanceToPoint(t))}intersectLine(t,e,i=!0){let s=t.delta(wf),r=this.normal.dot(s);if(r===0)return this.distanceToPoint(t.start)===0?e.copy(t.start):null;let o=-(t.start.dot(this.normal)+this.constant)/r;return i===!0&&(o<0||o>1)?null:e.copy(t.start).addScaledVector(s,o)}intersectsLine(t){let e=this.distanceToPoint(t.start),i=this.distanceToPoint(t.end);return e<0&&i>0||i<0&&e>0}intersectsBox(t){return t.intersectsPlane(this)}intersectsSphere(t){return t.intersectsPlane(this)}coplanarPoint(t){return t.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(t,e){let i=e||zS.getNormalMatrix(t),s=this.coplanarPoint(wf).applyMatrix4(t),r=this.normal.applyMatrix3(i).normalize();return this.constant=-s.dot(r),this}translate(t){return this.constant-=t.dot(this.normal),this}equals(t){return t.normal.equals(this.normal)&&t.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(t){return this.normal.fromArray(t.normal),this.constant=t.constant,this}},HS=0,Cs=class extends Vi{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:HS++}),this.uuid=To(),this.name="",this.type="Material",this.blending=Mo,this.side=or,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=kf,this.blendDst=zf,this.blendEquation=wr,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new ue(0,0,0),this.blendAlpha=0,this.depthFunc=co,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=kg,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=fc,this.stencilZFail=fc,this.stencilZPass=fc,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(t){this._alphaTest>0!=t>0&&this.version++,this._alphaTest=t}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(t){if(t!==void 0)for(let e in t){let i=t[e];if(i===void 0){Kt(`Material: parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Kt(`Material: '${e}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(i):s&&s.isVector2&&i&&i.isVector2||s&&s.isEuler&&i&&i.isEuler||s&&s.isVector3&&i&&i.isVector3?s.copy(i):this[e]=i}}toJSON(t){let e=t===void 0||typeof t=="string";e&&(t={textures:{},images:{}});let i={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};i.uuid=this.uuid,i.type=this.type,i.blending=this.blending,i.side=this.side,i.shadowSide=this.shadowSide,i.vertexColors=this.vertexColors,i.opacity=this.opacity,i.transparent=this.transparent,i.blendSrc=this.blendSrc,i.blendDst=this.blendDst,i.blendEquation=this.blendEquation,i.blendSrcAlpha=this.blendSrcAlpha,i.blendDstAlpha=this.blendDstAlpha,i.blendEquationAlpha=this.blendEquationAlpha,i.blendColor=this.blendColor.getHex(),i.blendAlpha=this.blendAlpha,i.depthFunc=this.depthFunc,i.depthTest=this.depthTest,i.depthWrite=this.depthWrite,i.colorWrite=this.colorWrite,i.clipIntersection=this.clipIntersection,i.clipShadows=this.clipShadows,i.stencilWriteMask=this.stencilWriteMask,i.stencilFunc=this.stencilFunc,i.stencilRef=this.stencilRef,i.stencilFuncMask=this.stencilFuncMask,i.stencilFail=this.stencilFail,i.stencilZFail=this.stencilZFail,i.stencilZPass=this.stencilZPass,i.stencilWrite=this.stencilWrite,i.polygonOffset=this.polygonOffset,i.polygonOffsetFactor=this.polygonOffsetFactor,i.polygonOffsetUnits=this.polygonOffsetUnits,i.dithering=this.dithering,i.alphaTest=this.alphaTest,i.alphaHash=this.alphaHash,i.alphaToCoverage=this.alphaToCoverage,i.premultipliedAlpha=this.premultipliedAlpha,i.forceSinglePass=this.forceSinglePass,i.allowOverride=this.allowOverride,i.visible=this.visible,i.toneMapped=this.toneMapped,i.name=this.name,this.color&&this.color.isColor&&(i.color=this.color.getHex()),this.roughness!==void 0&&(i.roughness=this.roughness),this.metalness!==void 0&&(i.metalness=this.metalness),this.sheen!==void 0&&(i.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(i.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(i.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(i.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(i.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(i.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(i.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(i.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(i.shininess=this.shininess),this.clearcoat!==void 0&&(i.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(i.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(i.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(i.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(t).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(i.clearcoatMap=this.clearcoatMap.toJSON(t).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(i.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(t).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(i.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(t).uuid,i.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(i.sheenColorMap=this.sheenColorMap.toJSON(t).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(i.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(t).uuid),this.dispersion!==void 0&&(i.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(i.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(i.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(i.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(i.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(i.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(i.iridescenceMap=this.iridescenceMap.toJSON(t).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(i.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(t).uuid),this.anisotropy!==void 0&&(i.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(i.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(i.anisotropyMap=this.anisotropyMap.toJSON(t).uuid),this.map&&this.map.isTexture&&(i.map=this.map.toJSON(t).uuid),this.matcap&&this.matcap.isTexture&&(i.matcap=this.matcap.toJSON(t).uuid),this.alphaMap&&this.alphaMap.isTexture&&(i.alphaMap=this.alphaMap.toJSON(t).uuid),this.lightMap&&this.lightMap.isTexture&&(i.lightMap=this.lightMap.toJSON(t).uuid,i.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(i.aoMap=this.aoMap.toJSON(t).uuid,i.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(i.bumpMap=this.bumpMap.toJSON(t).uuid,i.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(i.normalMap=this.normalMap.toJSON(t).uuid,i.normalMapType=this.normalMapType,i.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(i.displacementMap=this.displacementMap.toJSON(t).uuid,i.displacementScale=this.displacementScale,i.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(i.roughnessMap=this.roughnessMap.toJSON(t).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(i.metalnessMap=this.metalnessMap.toJSON(t).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(i.emissiveMap=this.emissiveMap.toJSON(t).uuid),this.specularMap&&this.specularMap.isTexture&&(i.specularMap=this.specularMap.toJSON(t).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(i.specularIntensityMap=this.specularIntensityMap.toJSON(t).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(i.specularColorMap=this.specularColorMap.toJSON(t).uuid),this.envMap&&this.envMap.isTexture&&(i.envMap=this.envMap.toJSON(t).uuid,this.combine!==void 0&&(i.combine=this.combine)),this.envMapRotation!==void 0&&(i.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(i.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(i.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(i.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(i.gradientMap=this.gradientMap.toJSON(t).uuid),this.transmission!==void 0&&(i.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(i.transmissionMap=this.transmissionMap.toJSON(t).uuid),this.thickness!==void 0&&(i.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(i.thicknessMap=this.thicknessMap.toJSON(t).uuid),this.attenuationDistance!==void 0&&(i.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(i.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(i.size=this.size),this.sizeAttenuation!==void 0&&(i.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(i.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(i.rotation=this.rotation),this.depthPacking!==void 0&&(i.depthPacking=this.depthPacking),this.linewidth!==void 0&&(i.linewidth=this.linewidth),this.linecap!==void 0&&(i.linecap=this.linecap),this.linejoin!==void 0&&(i.linejoin=this.linejoin),this.dashSize!==void 0&&(i.dashSize=this.dashSize),this.gapSize!==void 0&&(i.gapSize=this.gapSize),this.scale!==void 0&&(i.scale=this.scale),this.wireframe!==void 0&&(i.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(i.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(i.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(i.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(i.flatShading=this.flatShading),this.fog!==void 0&&(i.fog=this.fog),Object.keys(this.userData).length>0&&(i.userData=this.userData);function s(r){let o=[];for(let a in r){let c=r[a];delete c.metadata,o.push(c)}return o}if(e){let r=s(t.textures),o=s(t.images);r.length>0&&(i.textures=r),o.length>0&&(i.images=o)}return i}fromJSON(t,e){if(t.uuid!==void 0&&(this.uuid=t.uuid),t.name!==void 0&&(this.name=t.name),t.color!==void 0&&this.color!==void 0&&this.color.setHex(t.color),t.roughness!==void 0&&(this.roughness=t.roughness),t.metalness!==void 0&&(this.metalness=t.metalness),t.sheen!==void 0&&(this.sheen=t.sheen),t.sheenColor!==void 0&&(this.sheenColor=new ue().setHex(t.sheenColor)),t.sheenRoughness!==void 0&&(this.sheenRoughness=t.sheenRoughness),t.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(t.emissive),t.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(t.specular),t.specularIntensity!==void 0&&(this.specularIntensity=t.specularIntensity),t.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(t.specularColor),t.shininess!==void 0&&(this.shininess=t.shininess),t.clearcoat!==void 0&&(this.clearcoat=t.clearcoat),t.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=t.clearcoatRoughness),t.diffuseRoughness!==void 0&&(this.diffuseRoughness=t.diffuseRoughness),t.dispersion!==void 0&&(this.dispersion=t.dispersion),t.retroreflectivity!==void 0&&(this.retroreflectivity=t.retroreflectivity),t.iridescence!==void 0&&(this.iridescence=t.iridescence),t.iridescenceIOR!==void 0&&(this.iridescenceIOR=t.iridescenceIOR),t.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessMinimum),t.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=t.iridescenceThicknessMaximum),t.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=t.iridescenceThicknessRange[1]),t.transmission!==void 0&&(this.transmission=t.transmission),t.thickness!==void 0&&(this.thickness=t.thickness),t.attenuationDistance!==void 0&&(this.attenuationDistance=t.attenuationDistance),t.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(t.attenuationColor),t.anisotropy!==void 0&&(this.anisotropy=t.anisotropy),t.anisotropyRotation!==void 0&&(this.anisotropyRotation=t.anisotropyRotation),t.fog!==void 0&&(this.fog=t.fog),t.flatShading!==void 0&&(this.flatShading=t.flatShading),t.blending!==void 0&&(this.blending=t.blending),t.combine!==void 0&&(this.combine=t.combine),t.side!==void 0&&(this.side=t.side),t.shadowSide!==void 0&&(this.shadowSide=t.shadowSide),t.opacity!==void 0&&(this.opacity=t.opacity),t.transparent!==void 0&&(this.transparent=t.transparent),t.alphaTest!==void 0&&(this.alphaTest=t.alphaTest),t.alphaHash!==void 0&&(this.alphaHash=t.alphaHash),t.depthFunc!==void 0&&(this.depthFunc=t.depthFunc),t.depthTest!==void 0&&(this.depthTest=t.depthTest),t.depthWrite!==void 0&&(this.depthWrite=t.depthWrite),t.colorWrite!==void 0&&(this.colorWrite=t.colorWrite),t.clippingPlanes!==void 0&&(this.clippingPlanes=t.clippingPlanes.map(i=>new xi().fromJSON(i))),t.clipIntersection!==void 0&&(this.clipIntersection=t.clipIntersection),t.clipShadows!==void 0&&(this.clipShadows=t.clipShadows),t.depthPacking!==void 0&&(this.depthPacking=t.depthPacking),t.blendSrc!==void 0&&(this.blendSrc=t.blendSrc),t.blendDst!==void 0&&(this.blendDst=t.blendDst),t.blendEquation!==void 0&&(this.blendEquation=t.blendEquation),t.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=t.blendSrcAlpha),t.blendDstAlpha!==void 0&&(this.blendDstAlpha=t.blendDstAlpha),t.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=t.blendEquationAlpha),t.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(t.blendColor),t.blendAlpha!==void 0&&(this.blendAlpha=t.blendAlpha),t.stencilWriteMask!==void 0&&(this.stencilWriteMask=t.stencilWriteMask),t.stencilFunc!==void 0&&(this.stencilFunc=t.stencilFunc),t.stencilRef!==void 0&&(this.stencilRef=t.stencilRef),t.stencilFuncMask!==void 0&&(this.stencilFuncMask=t.stencilFuncMask),t.stencilFail!==void 0&&(this.stencilFail=t.stencilFail),t.stencilZFail!==void 0&&(this.stencilZFail=t.stencilZFail),t.stencilZPass!==void 0&&(this.stencilZPass=t.stencilZPass),t.stencilWrite!==void 0&&(this.stencilWrite=t.stencilWrite),t.wireframe!==void 0&&(this.wireframe=t.wireframe),t.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=t.wireframeLinewidth),t.wireframeLinecap!==void 0&&(this.wireframeLinecap=t.wireframeLinecap),t.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=t.wireframeLinejoin),t.rotation!==void 0&&(this.rotation=t.rotation),t.linewidth!==void 0&&(this.linewidth=t.linewidth),t.linecap!==void 0&&(this.linecap=t.linecap),t.linejoin!==void 0&&(this.linejoin=t.linejoin),t.dashSize!==void 0&&(this.dashSize=t.dashSize),t.gapSize!==void 0&&(this.gapSize=t.gapSize),t.scale!==void 0&&(this.scale=t.scale),t.polygonOffset!==void 0&&(this.polygonOffset=t.polygonOffset),t.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=t.polygonOffsetFactor),t.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=t.polygonOffsetUnits),t.dithering!==void 0&&(this.dithering=t.dithering),t.alphaToCoverage!==void 0&&(this.alphaToCoverage=t.alphaToCoverage),t.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=t.premultipliedAlpha),t.forceSinglePass!==void 0&&(this.forceSinglePass=t.forceSinglePass),t.allowOverride!==void 0&&(this.allowOverride=t.allowOverride),t.visible!==void 0&&(this.visible=t.visible),t.toneMapped!==void 0&&(this.toneMapped=t.toneMapped),t.userData!==void 0&&(this.userData=t.userData),t.vertexColors!==void 0&&(typeof t.vertexColors=="number"?this.vertexColors=t.vertexColors>0:this.vertexColors=t.vertexColors),t.size!==void 0&&(this.size=t.size),t.sizeAttenuation!==void 0&&(this.sizeAttenuation=t.sizeAttenuation),t.map!==void 0&&(this.map=e[t.map]||null),t.matcap!==void 0&&(this.matcap=e[t.matcap]||null),t.alphaMap!==void 0&&(this.alphaMap=e[t.alphaMap]||null),t.bumpMap!==void 0&&(this.bumpMap=e[t.bumpMap]||null),t.bumpScale!==void 0&&(this.bumpScale=t.bumpScale),t.normalMap!==void 0&&(this.normalMap=e[t.normalMap]||null),t.normalMapType!==void 0&&(this.normalMapType=t.normalMapType),t.normalScale!==void 0){let i=t.normalScale;Array.isArray(i)===!1&&(i=[i,i]),this.normalScale=new jt().fromArray(i)}return t.displacementMap!==void 0&&(this.displacementMap=e[t.displacementMap]||null),t.displacementScale!==void 0&&(this.displacementScale=t.displacementScale),t.displacementBias!==void 0&&(this.displacementBias=t.displacementBias),t.roughnessMap!==void 0&&(this.roughnessMap=e[t.roughnessMap]||null),t.metalnessMap!==void 0&&(this.metalnessMap=e[t.metalnessMap]||null),t.emissiveMap!==void 0&&(this.emissiveMap=e[t.emissiveMap]||null),t.emissiveIntensity!==void 0&&(this.emissiveIntensity=t.emissiveIntensity),t.specularMap!==void 0&&(this.specularMap=e[t.specularMap]||null),t.specularIntensityMap!==void 0&&(this.specularIntensityMap=e[t.specularIntensityMap]||null),t.specularColorMap!==void 0&&(this.specularColorMap=e[t.specularColorMap]||null),t.envMap!==void 0&&(this.envMap=e[t.envMap]||null),t.envMapRotation!==void 0&&this.envMapRotation.fromArray(t.envMapRotation),t.envMapIntensity!==void 0&&(this.envMapIntensity=t.envMapIntensity),t.reflectivity!==void 0&&(this.reflectivity=t.reflectivity),t.refractionRatio!==void 0&&(this.refractionRatio=t.refractionRatio),t.lightMap!==void 0&&(this.lightMap=e[t.lightMap]||null),t.lightMapIntensity!==void 0&&(this.lightMapIntensity=t.lightMapIntensity),t.aoMap!==void 0&&(this.aoMap=e[t.aoMap]||null),t.aoMapIntensity!==void 0&&(this.aoMapIntensity=t.aoMapIntensity),t.gradientMap!==void 0&&(this.gradientMap=e[t.gradientMap]||null),t.clearcoatMap!==void 0&&(this.clearcoatMap=e[t.clearcoatMap]||null),t.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=e[t.clearcoatRoughnessMap]||null),t.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=e[t.clearcoatNormalMap]||null),t.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new jt().fromArray(t.clearcoatNormalScale)),t.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=e[t.diffuseRoughnessMap]||null),t.iridescenceMap!==void 0&&(this.iridescenceMap=e[t.iridescenceMap]||null),t.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=e[t.iridescenceThicknessMap]||null),t.transmissionMap!==void 0&&(this.transmissionMap=e[t.transmissionMap]||null),t.thicknessMap!==void 0&&(this.thicknessMap=e[t.thicknessMap]||null),t.anisotropyMap!==void 0&&(this.anisotropyMap=e[t.anisotropyMap]||null),t.sheenColorMap!==void 0&&(this.sheenColorMap=e[t.sheenColorMap]||null),t.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=e[t.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(t){this.name=t.name,this.blending=t.blending,this.side=t.side,this.vertexColors=t.vertexColors,this.opacity=t.opacity,this.transparent=t.transparent,this.blendSrc=t.blendSrc,this.blendDst=t.blendDst,this.blendEquation=t.blendEquation,this.blendSrcAlpha=t.blendSrcAlpha,this.blendDstAlpha=t.blendDstAlpha,this.blendEquationAlpha=t.blendEquationAlpha,this.blendColor.copy(t.blendColor),this.blendAlpha=t.blendAlpha,this.depthFunc=t.depthFunc,this.depthTest=t.depthTest,this.depthWrite=t.depthWrite,this.stencilWriteMask=t.stencilWriteMask,this.stencilFunc=t.stencilFunc,this.stencilRef=t.stencilRef,this.stencilFuncMask=t.stencilFuncMask,this.stencilFail=t.stencilFail,this.stencilZFail=t.stencilZFail,this.stencilZPass=t.stencilZPass,this.stencilWrite=t.stencilWrite;let e=t.clippingPlanes,i=null;if(e!==null){let s=e.length;i=new Array(s);for(let r=0;r!==s;++r)i[r]=e[r].clone()}return this.clippingPlanes=i,this.clipIntersection=t.clipIntersection,this.clipShadows=t.clipShadows,this.shadowSide=t.shadowSide,this.colorWrite=t.colorWrite,this.precision=t.precision,this.polygonOffset=t.polygonOffset,this.polygonOffsetFactor=t.polygonOffsetFactor,this.polygonOffsetUnits=t.polygonOffsetUnits,this.dithering=t.dithering,this.alphaTest=t.alphaTest,this.alphaHash=t.alphaHash,this.alphaToCoverage=t.alphaToCoverage,this.premultipliedAlpha=t.premultipliedAlpha,this.forceSinglePass=t.forceSinglePass,this.allowOverride=t.allowOverride,this.visible=t.visible,this.toneMapped=t.toneMapped,this.userData=JSON.parse(JSON.stringify(t.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(t){t===!0&&this.version++}};var ws=new $,Mf=new $,Kl=new $,Jl=new $,Sr=class{constructor(t=new $,e=new $(0,0,-1)){this.origin=t,this.direction=e}set(t,e){return this.origin.copy(t),this.direction.copy(e),this}copy(t){return this.origin.copy(t.origin),this.direction.copy(t.direction),this}at(t,e){return e.copy(this.origin).addScaledVector(this.direction,t)}lookAt(t){return this.direction.copy(t).sub(this.origin).normalize(),this}recast(t){return this.origin.copy(this.at(t,ws)),this}closestPointToPoint(t,e){e.subVectors(t,this.origin);let i=e.dot(this.direction);return i<0?e.copy(this.origin):e.copy(this.origin).addScaledVector(this.direction,i)}distanceToPoint(t){return Math.sqrt(this.distanceSqToPoint(t))}distanceSqToPoint(t){let e=ws.subVectors(t,this.origin).dot(this.direction);return e<0?this.origin.distanceToSquared(t):(ws.copy(this.origin).addScaledVector(this.direction,e),ws.distanceToSquared(t))}distanceSqToSegment(t,e,i,s){Mf.copy(t).add(e).multiplyScalar(.5),Kl.copy(e).sub(t).normalize(),Jl.copy(this.origin).sub(Mf);let r=t.distanceTo(e)*.5,o=-this.direction.dot(Kl),a=Jl.dot(this.direction),c=-Jl.dot(Kl),l=Jl.lengthSq(),h=Math.abs(1-o*o),f,u,d,p;if(h>0)if(f=o*c-a,u=o*a-c,p=r*h,f>=0)if(u>=-p)if(u<=p){let _=1/h;f*=_,u*=_,d=f*(f+o*u+2*a)+u*(o*f+u+2*c)+l}else u=r,f=Math.max(0,-(o*u+a)),d=-f*f+u*(u+2*c)+l;else u=-r,f=Math.max(0,-(o*u+a)),d=-f*f+u*(u+2*c)+l;else u<=-p?(f=Math.max(0,-(-o*r+a)),u=f>0?-r:Math.min(Math.max(-r,-c),r),d=-f*f+u*(u+2*c)+l):u<=p?(f=0,u=Math.min(Math.max(-r,-c),r),d=u*(u+2*c)+l):(f=Math.max(0,-(o*r+a)),u=f>0?r:Math.min(Math.max(-r,-c),r),d=-f*f+u*(u+2*c)+l);else u=o>0?-r:r,f=Math.max(0,-(o*u+a)),d=-f*f+u*(u+2*c)+l;return i&&i.copy(this.origin).addScaledVector(this.direction,f),s&&s.copy(Mf).addScaledVector(Kl,u),d}intersectSphere(t,e){if(t.radius<0)return null;ws.subVectors(t.center,this.origin);let i=ws.dot(this.direction),s=ws.dot(ws)-i*i,r=t.radius*t.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=i-o,c=i+o;return c<0?null:a<0?this.at(c,e):this.at(a,e)}intersectsSphere(t){return t.radius<0?!1:this.distanceSqToPoint(t.center)<=t.radius*t.radius}distanceToPlane(t){let e=t.normal.dot(this.direction);if(e===0)return t.distanceToPoint(this.origin)===0?0:null;let i=-(this.origin.dot(t.normal)+t.constant)/e;return i>=0?i:null}intersectPlane(t,e){let i=this.distanceToPlane(t);return i===null?null:this.at(i,e)}intersectsPlane(t){let e=t.distanceToPoint(this.origin);return e===0||t.normal.dot(this.direction)*e<0}intersectBox(t,e){let i,s,r,o,a,c,l=1/this.direction.x,h=1/this.direction.y,f=1/this.direction.z,u=this.origin;return l>=0?(i=(t.min.x-u.x)*l,s=(t.max.x-u.x)*l):(i=(t.max.x-u.x)*l,s=(t.min.x-u.x)*l),h>=0?(r=(t.min.y-u.y)*h,o=(t.max.y-u.y)*h):(r=(t.max.y-u.y)*h,o=(t.min.y-u.y)*h),i>o||r>s||((r>i||isNaN(i))&&(i=r),(o<s||isNaN(s))&&(s=o),f>=0?(a=(t.min.z-u.z)*f,c=(t.max.z-u.z)*f):(a=(t.max.z-u.z)*f,c=(t.min.z-u.z)*f),i>c||a>s)||((a>i||i!==i)&&(i=a),(c<s||s!==s)&&(s=c),s<0)?null:this.at(i>=0?i:s,e)}intersectsBox(t){return this.intersectBox(t,ws)!==null}intersectTriangle(t,e,i,s,r){let o=this.origin,a=this.direction,c=a.x,l=a.y,h=a.z,f=t.x-o.x,u=t.y-o.y,d=t.z-o.z,p=e.x-o.x,_=e.y-o.y,m=e.z-o.z,g=i.x-o.x,v=i.y-o.y,T=i.z-o.z,S=Math.abs(c),C=Math.abs(l),E=Math.abs(h),y,w,V,N,L,B,F,R,U,X,G,ct;if(S>=C&&S>=E?(V=c,B=f,U=p,ct=g,c>=0?(y=l,w=h,N=u,L=d,F=_,R=m,X=v,G=T):(y=h,w=l,N=d,L=u,F=m,R=_,X=T,G=v)):C>=E?(V=l,B=u,U=_,ct=v,l>=0?(y=h,w=c,N=d,L=f,F=m,R=p,X=T,G=g):(y=c,w=h,N=f,L=d,F=p,R=m,X=g,G=T)):(V=h,B=d,U=m,ct=T,h>=0?(y=c,w=l,N=f,L=u,F=p,R=_,X=g,G=v):(y=l,w=c,N=u,L=f,F=_,R=p,X=v,G=g)),V===0)return null;let I=y/V,k=w/V,Y=1/V,et=N-I*B,nt=L-k*B,Z=F-I*U,at=R-k*U,ut=X-I*ct,dt=G-k*ct,ot=ut*at-dt*Z,Lt=et*dt-nt*ut,Zt=Z*nt-at*et;if(s){if(ot<0||Lt<0||Zt<0)return null}else if((ot<0||Lt<0||Zt<0)&&(ot>0||Lt>0||Zt>0))return null;let Ut=ot+Lt+Zt;if(Ut===0)return null;let ne=Y*(ot*B+Lt*U+Zt*ct);return(Ut>0?ne<0:ne>0)?null:this.at(ne/Ut,r)}applyMatrix4(t){return this.origin.applyMatrix4(t),this.direction.transformDirection(t),this}equals(t){return t.origin.equals(this.origin)&&t.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},go=class extends Cs{constructor(t){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new ue(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new As,this.combine=$c,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.fog=t.fog,this}},jm=new Be,xr=new Sr,jl=new Ts,Qm=new $,Ql=new $,tc=new $,ec=new $,Ef=new $,nc=new $,tg=new $,ic=new $,ni=class extends zn{constructor(t=new Hn,e=new go){super(),this.isMesh=!0,this.type="Mesh",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}updateMorphTargets(){let e=this.geometry.morphAttributes,i=Object.keys(e);if(i.length>0){let s=e[i[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(t,e){let i=this.geometry,s=i.attributes.position,r=i.morphAttributes.position,o=i.morphTargetsRelative;e.fromBufferAttribute(s,t);let a=this.morphTargetInfluences;if(r&&a){nc.set(0,0,0);for(let c=0,l=r.length;c<l;c++){let h=a[c],f=r[c];h!==0&&(Ef.fromBufferAttribute(f,t),o?nc.addScaledVector(Ef,h):nc.addScaledVector(Ef.sub(e),h))}e.add(nc)}return e}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let i=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(i.boundingSphere===null&&i.computeBoundingSphere(),jl.copy(i.boundingSphere),jl.applyMatrix4(r),xr.copy(t.ray).recast(t.near),!(jl.containsPoint(xr.origin)===!1&&(xr.intersectSphere(jl,Qm)===null||xr.origin.distanceToSquared(Qm)>(t.far-t.near)**2))&&(jm.copy(r).invert(),xr.copy(t.ray).applyMatrix4(jm),!(i.boundingBox!==null&&xr.intersectsBox(i.boundingBox)===!1)&&this._computeIntersections(t,e,xr)))}_computeIntersections(t,e,i){let s,r=this.geometry,o=this.material,a=r.index,c=r.attributes.position,l=r.attributes.uv,h=r.attributes.uv1,f=r.attributes.normal,u=r.groups,d=r.drawRange;if(a!==null)if(Array.isArray(o))for(let p=0,_=u.length;p<_;p++){let m=u[p],g=o[m.materialIndex],v=Math.max(m.start,d.start),T=Math.min(a.count,Math.min(m.start+m.count,d.start+d.count));for(let S=v,C=T;S<C;S+=3){let E=a.getX(S),y=a.getX(S+1),w=a.getX(S+2);s=sc(this,g,t,i,l,h,f,E,y,w),s&&(s.faceIndex=Math.floor(S/3),s.face.materialIndex=m.materialIndex,e.push(s))}}else{let p=Math.max(0,d.start),_=Math.min(a.count,d.start+d.count);for(let m=p,g=_;m<g;m+=3){let v=a.getX(m),T=a.getX(m+1),S=a.getX(m+2);s=sc(this,o,t,i,l,h,f,v,T,S),s&&(s.faceIndex=Math.floor(m/3),e.push(s))}}else if(c!==void 0)if(Array.isArray(o))for(let p=0,_=u.length;p<_;p++){let m=u[p],g=o[m.materialIndex],v=Math.max(m.start,d.start),T=Math.min(c.count,Math.min(m.start+m.count,d.start+d.count));for(let S=v,C=T;S<C;S+=3){let E=S,y=S+1,w=S+2;s=sc(this,g,t,i,l,h,f,E,y,w),s&&(s.faceIndex=Math.floor(S/3),s.face.materialIndex=m.materialIndex,e.push(s))}}else{let p=Math.max(0,d.start),_=Math.min(c.count,d.start+d.count);for(let m=p,g=_;m<g;m+=3){let v=m,T=m+1,S=m+2;s=sc(this,o,t,i,l,h,f,v,T,S),s&&(s.faceIndex=Math.floor(m/3),e.push(s))}}}};function VS(n,t,e,i,s,r,o,a){let c;if(t.side===ii?c=i.intersectTriangle(o,r,s,!0,a):c=i.intersectTriangle(s,r,o,t.side===or,a),c===null)return null;ic.copy(a),ic.applyMatrix4(n.matrixWorld);let l=e.ray.origin.distanceTo(ic);return l<e.near||l>e.far?null:{distance:l,point:ic.clone(),object:n}}function sc(n,t,e,i,s,r,o,a,c,l){n.getVertexPosition(a,Ql),n.getVertexPosition(c,tc),n.getVertexPosition(l,ec);let h=VS(n,t,e,i,Ql,tc,ec,tg);if(h){let f=new $;js.getBarycoord(tg,Ql,tc,ec,f),s&&(h.uv=js.getInterpolatedAttribute(s,a,c,l,f,new jt)),r&&(h.uv1=js.getInterpolatedAttribute(r,a,c,l,f,new jt)),o&&(h.normal=js.getInterpolatedAttribute(o,a,c,l,f,new $),h.normal.dot(i.direction)>0&&h.normal.multiplyScalar(-1));let u={a,b:c,c:l,normal:new $,materialIndex:0};js.getNormal(Ql,tc,ec,u.normal),h.face=u,h.barycoord=f}return h}var _o=class extends ci{constructor(t=null,e=1,i=1,s,r,o,a,c,l=Nn,h=Nn,f,u){super(null,o,a,c,l,h,s,r,f,u),this.isDataTexture=!0,this.image={data:t,width:e,height:i},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var vr=new Ts,GS=new jt(.5,.5),rc=new $,Qs=class{constructor(t=new xi,e=new xi,i=new xi,s=new xi,r=new xi,o=new xi){this.planes=[t,e,i,s,r,o]}set(t,e,i,s,r,o){let a=this.planes;return a[0].copy(t),a[1].copy(e),a[2].copy(i),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(t){let e=this.planes;for(let i=0;i<6;i++)e[i].copy(t.planes[i]);return this}setFromProjectionMatrix(t,e=Ii,i=!1){let s=this.planes,r=t.elements,o=r[0],a=r[1],c=r[2],l=r[3],h=r[4],f=r[5],u=r[6],d=r[7],p=r[8],_=r[9],m=r[10],g=r[11],v=r[12],T=r[13],S=r[14],C=r[15];if(s[0].setComponents(l-o,d-h,g-p,C-v).normalize(),s[1].setComponents(l+o,d+h,g+p,C+v).normalize(),s[2].setComponents(l+a,d+f,g+_,C+T).normalize(),s[3].setComponents(l-a,d-f,g-_,C-T).normalize(),i)s[4].setComponents(c,u,m,S).normalize(),s[5].setComponents(l-c,d-u,g-m,C-S).normalize();else if(s[4].setComponents(l-c,d-u,g-m,C-S).normalize(),e===Ii)s[5].setComponents(l+c,d+u,g+m,C+S).normalize();else if(e===ho)s[5].setComponents(c,u,m,S).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+e);return this}intersectsObject(t){if(t.boundingSphere!==void 0)t.boundingSphere===null&&t.computeBoundingSphere(),vr.copy(t.boundingSphere).applyMatrix4(t.matrixWorld);else{let e=t.geometry;e.boundingSphere===null&&e.computeBoundingSphere(),vr.copy(e.boundingSphere).applyMatrix4(t.matrixWorld)}return this.intersectsSphere(vr)}intersectsSprite(t){vr.center.set(0,0,0);let e=GS.distanceTo(t.center);return vr.radius=.7071067811865476+e,vr.applyMatrix4(t.matrixWorld),this.intersectsSphere(vr)}intersectsSphere(t){let e=this.planes,i=t.center,s=-t.radius;for(let r=0;r<6;r++)if(e[r].distanceToPoint(i)<s)return!1;return!0}intersectsBox(t){let e=this.planes;for(let i=0;i<6;i++){let s=e[i];if(rc.x=s.normal.x>0?t.max.x:t.min.x,rc.y=s.normal.y>0?t.max.y:t.min.y,rc.z=s.normal.z>0?t.max.z:t.min.z,s.distanceToPoint(rc)<0)return!1}return!0}containsPoint(t){let e=this.planes;for(let i=0;i<6;i++)if(e[i].distanceToPoint(t)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},eg=new Be,Ac=class n{constructor(){this.coordinateSystem=Ii,this._frustums=[],this._count=0}setFromArrayCamera(t){let e=t.cameras,i=this._frustums;for(let s=0;s<e.length;s++){let r=e[s];eg.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),i[s]===void 0&&(i[s]=new Qs),i[s].setFromProjectionMatrix(eg,r.coordinateSystem,r.reversedDepth)}return this._count=e.length,this}getFrustum(t){return this._frustums[t]}intersectsObject(t){let e=this._frustums;for(let i=0;i<this._count;i++)if(e[i].intersectsObject(t))return!0;return!1}intersectsSprite(t){let e=this._frustums;for(let i=0;i<this._count;i++)if(e[i].intersectsSprite(t))return!0;return!1}intersectsSphere(t){let e=this._frustums;for(let i=0;i<this._count;i++)if(e[i].intersectsSphere(t))return!0;return!1}intersectsBox(t){let e=this._frustums;for(let i=0;i<this._count;i++)if(e[i].intersectsBox(t))return!0;return!1}containsPoint(t){let e=this._frustums;for(let i=0;i<this._count;i++)if(e[i].containsPoint(t))return!0;return!1}copy(t){this.coordinateSystem=t.coordinateSystem;let e=this._frustums,i=t._frustums;for(let s=0;s<t._count;s++)e[s]===void 0&&(e[s]=new Qs),e[s].copy(i[s]);return this._count=t._count,this}clone(){return new n().copy(this)}};var yo=class extends Cs{constructor(t){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new ue(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.linewidth=t.linewidth,this.linecap=t.linecap,this.linejoin=t.linejoin,this.fog=t.fog,this}},Tc=new $,Cc=new $,ng=new Be,_a=new Sr,oc=new Ts,Af=new $,ig=new $,Rc=class extends zn{constructor(t=new Hn,e=new yo){super(),this.isLine=!0,this.type="Line",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,i=[0];for(let s=1,r=e.count;s<r;s++)Tc.fromBufferAttribute(e,s-1),Cc.fromBufferAttribute(e,s),i[s]=i[s-1],i[s]+=Tc.distanceTo(Cc);t.setAttribute("lineDistance",new tn(i,1))}else Kt("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let i=this.geometry,s=this.matrixWorld,r=t.params.Line.threshold,o=i.drawRange;if(i.boundingSphere===null&&i.computeBoundingSphere(),oc.copy(i.boundingSphere),oc.applyMatrix4(s),oc.radius+=r,t.ray.intersectsSphere(oc)===!1)return;ng.copy(s).invert(),_a.copy(t.ray).applyMatrix4(ng);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),c=a*a,l=this.isLineSegments?2:1,h=i.index,u=i.attributes.position;if(h!==null){let d=Math.max(0,o.start),p=Math.min(h.count,o.start+o.count);for(let _=d,m=p-1;_<m;_+=l){let g=h.getX(_),v=h.getX(_+1),T=ac(this,t,_a,c,g,v,_);T&&e.push(T)}if(this.isLineLoop){let _=h.getX(p-1),m=h.getX(d),g=ac(this,t,_a,c,_,m,p-1);g&&e.push(g)}}else{let d=Math.max(0,o.start),p=Math.min(u.count,o.start+o.count);for(let _=d,m=p-1;_<m;_+=l){let g=ac(this,t,_a,c,_,_+1,_);g&&e.push(g)}if(this.isLineLoop){let _=ac(this,t,_a,c,p-1,d,p-1);_&&e.push(_)}}}updateMorphTargets(){let e=this.geometry.morphAttributes,i=Object.keys(e);if(i.length>0){let s=e[i[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function ac(n,t,e,i,s,r,o){let a=n.geometry.attributes.position;if(Tc.fromBufferAttribute(a,s),Cc.fromBufferAttribute(a,r),e.distanceSqToSegment(Tc,Cc,Af,ig)>i)return;Af.applyMatrix4(n.matrixWorld);let l=t.ray.origin.distanceTo(Af);if(!(l<t.near||l>t.far))return{distance:l,point:ig.clone().applyMatrix4(n.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:n}}var sg=new $,rg=new $,Ia=class extends Rc{constructor(t,e){super(t,e),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,i=[];for(let s=0,r=e.count;s<r;s+=2)sg.fromBufferAttribute(e,s),rg.fromBufferAttribute(e,s+1),i[s]=s===0?0:i[s-1],i[s+1]=i[s]+sg.distanceTo(rg);t.setAttribute("lineDistance",new tn(i,1))}else Kt("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}};var Pa=class extends ci{constructor(t=[],e=Mr,i,s,r,o,a,c,l,h){super(t,e,i,s,r,o,a,c,l,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(t){this.image=t}};var Rs=class extends ci{constructor(t,e,i=Gi,s,r,o,a=Nn,c=Nn,l,h=Es,f=1){if(h!==Es&&h!==Ps)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");let u={width:t,height:e,depth:f};super(u,s,r,o,a,c,h,i,l),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(t){return super.copy(t),this.source=new po(Object.assign({},t.image)),this.compareFunction=t.compareFunction,this}toJSON(t){let e=super.toJSON(t);return e.compareFunction=this.compareFunction,e}},La=class extends Rs{constructor(t,e=Gi,i=Mr,s,r,o=Nn,a=Nn,c,l=Es){let h={width:t,height:t,depth:1},f=[h,h,h,h,h,h];super(t,t,e,i,s,r,o,a,c,l),this.image=f,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(t){this.image=t}},Da=class extends ci{constructor(t=null){super(),this.sourceTexture=t,this.isExternalTexture=!0}copy(t){return super.copy(t),this.sourceTexture=t.sourceTexture,this}},xo=class n extends Hn{constructor(t=1,e=1,i=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:t,height:e,depth:i,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let c=[],l=[],h=[],f=[],u=0,d=0;p("z","y","x",-1,-1,i,e,t,o,r,0),p("z","y","x",1,-1,i,e,-t,o,r,1),p("x","z","y",1,1,t,i,e,s,o,2),p("x","z","y",1,-1,t,i,-e,s,o,3),p("x","y","z",1,-1,t,e,i,s,r,4),p("x","y","z",-1,-1,t,e,-i,s,r,5),this.setIndex(c),this.setAttribute("position",new tn(l,3)),this.setAttribute("normal",new tn(h,3)),this.setAttribute("uv",new tn(f,2));function p(_,m,g,v,T,S,C,E,y,w,V){let N=S/y,L=C/w,B=S/2,F=C/2,R=E/2,U=y+1,X=w+1,G=0,ct=0,I=new $;for(let k=0;k<X;k++){let Y=k*L-F;for(let et=0;et<U;et++){let nt=et*N-B;I[_]=nt*v,I[m]=Y*T,I[g]=R,l.push(I.x,I.y,I.z),I[_]=0,I[m]=0,I[g]=E>0?1:-1,h.push(I.x,I.y,I.z),f.push(et/y),f.push(1-k/w),G+=1}}for(let k=0;k<w;k++)for(let Y=0;Y<y;Y++){let et=u+Y+U*k,nt=u+Y+U*(k+1),Z=u+(Y+1)+U*(k+1),at=u+(Y+1)+U*k;c.push(et,nt,at),c.push(nt,Z,at),ct+=6}a.addGroup(d,ct,V),d+=ct,u+=G}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new n(t.width,t.height,t.depth,t.widthSegments,t.heightSegments,t.depthSegments)}};var Na=class n extends Hn{constructor(t=1,e=32,i=0,s=Math.PI*2){super(),this.type="CircleGeometry",this.parameters={radius:t,segments:e,thetaStart:i,thetaLength:s},e=Math.max(3,e);let r=[],o=[],a=[],c=[],l=new $,h=new jt;o.push(0,0,0),a.push(0,0,1),c.push(.5,.5);for(let f=0,u=3;f<=e;f++,u+=3){let d=i+f/e*s;l.x=t*Math.cos(d),l.y=t*Math.sin(d),o.push(l.x,l.y,l.z),a.push(0,0,1),h.x=(o[u]/t+1)/2,h.y=(o[u+1]/t+1)/2,c.push(h.x,h.y)}for(let f=1;f<=e;f++)r.push(f,f+1,0);this.setIndex(r),this.setAttribute("position",new tn(o,3)),this.setAttribute("normal",new tn(a,3)),this.setAttribute("uv",new tn(c,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new n(t.radius,t.segments,t.thetaStart,t.thetaLength)}},vo=class n extends Hn{constructor(t=1,e=1,i=1,s=32,r=1,o=!1,a=0,c=Math.PI*2){super(),this.type="CylinderGeometry",this.parameters={radiusTop:t,radiusBottom:e,height:i,radialSegments:s,heightSegments:r,openEnded:o,thetaStart:a,thetaLength:c};let l=this;s=Math.floor(s),r=Math.floor(r);let h=[],f=[],u=[],d=[],p=0,_=[],m=i/2,g=0;v(),o===!1&&(t>0&&T(!0),e>0&&T(!1)),this.setIndex(h),this.setAttribute("position",new tn(f,3)),this.setAttribute("normal",new tn(u,3)),this.setAttribute("uv",new tn(d,2));function v(){let S=new $,C=new $,E=0,y=(e-t)/i;for(let w=0;w<=r;w++){let V=[],N=w/r,L=N*(e-t)+t;for(let B=0;B<=s;B++){let F=B/s,R=F*c+a,U=Math.sin(R),X=Math.cos(R);C.x=L*U,C.y=-N*i+m,C.z=L*X,f.push(C.x,C.y,C.z),S.set(U,y,X).normalize(),u.push(S.x,S.y,S.z),d.push(F,1-N),V.push(p++)}_.push(V)}for(let w=0;w<s;w++)for(let V=0;V<r;V++){let N=_[V][w],L=_[V+1][w],B=_[V+1][w+1],F=_[V][w+1];(t>0||V!==0)&&(h.push(N,L,F),E+=3),(e>0||V!==r-1)&&(h.push(L,B,F),E+=3)}l.addGroup(g,E,0),g+=E}function T(S){let C=p,E=new jt,y=new $,w=0,V=S===!0?t:e,N=S===!0?1:-1;for(let B=1;B<=s;B++)f.push(0,m*N,0),u.push(0,N,0),d.push(.5,.5),p++;let L=p;for(let B=0;B<=s;B++){let R=B/s*c+a,U=Math.cos(R),X=Math.sin(R);y.x=V*X,y.y=m*N,y.z=V*U,f.push(y.x,y.y,y.z),u.push(0,N,0),E.x=U*.5+.5,E.y=X*.5*N+.5,d.push(E.x,E.y),p++}for(let B=0;B<s;B++){let F=C+B,R=L+B;S===!0?h.push(R,R+1,F):h.push(R+1,R,F),w+=3}l.addGroup(g,w,S===!0?1:2),g+=w}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new n(t.radiusTop,t.radiusBottom,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},Oa=class n extends vo{constructor(t=1,e=1,i=32,s=1,r=!1,o=0,a=Math.PI*2){super(0,t,e,i,s,r,o,a),this.type="ConeGeometry",this.parameters={radius:t,height:e,radialSegments:i,heightSegments:s,openEnded:r,thetaStart:o,thetaLength:a}}static fromJSON(t){return new n(t.radius,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}};var Ua=class n extends Hn{constructor(t=1,e=1,i=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:t,height:e,widthSegments:i,heightSegments:s};let r=t/2,o=e/2,a=Math.floor(i),c=Math.floor(s),l=a+1,h=c+1,f=t/a,u=e/c,d=[],p=[],_=[],m=[];for(let g=0;g<h;g++){let v=g*u-o;for(let T=0;T<l;T++){let S=T*f-r;p.push(S,-v,0),_.push(0,0,1),m.push(T/a),m.push(1-g/c)}}for(let g=0;g<c;g++)for(let v=0;v<a;v++){let T=v+l*g,S=v+l*(g+1),C=v+1+l*(g+1),E=v+1+l*g;d.push(T,S,E),d.push(S,C,E)}this.setIndex(d),this.setAttribute("position",new tn(p,3)),this.setAttribute("normal",new tn(_,3)),this.setAttribute("uv",new tn(m,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new n(t.width,t.height,t.widthSegments,t.heightSegments)}},So=class n extends Hn{constructor(t=.5,e=1,i=32,s=1,r=0,o=Math.PI*2){super(),this.type="RingGeometry",this.parameters={innerRadius:t,outerRadius:e,thetaSegments:i,phiSegments:s,thetaStart:r,thetaLength:o},i=Math.max(3,i),s=Math.max(1,s);let a=[],c=[],l=[],h=[],f=t,u=(e-t)/s,d=new $,p=new jt;for(let _=0;_<=s;_++){for(let m=0;m<=i;m++){let g=r+m/i*o;d.x=f*Math.cos(g),d.y=f*Math.sin(g),c.push(d.x,d.y,d.z),l.push(0,0,1),p.x=(d.x/e+1)/2,p.y=(d.y/e+1)/2,h.push(p.x,p.y)}f+=u}for(let _=0;_<s;_++){let m=_*(i+1);for(let g=0;g<i;g++){let v=g+m,T=v,S=v+i+1,C=v+i+2,E=v+1;a.push(T,S,E),a.push(S,C,E)}}this.setIndex(a),this.setAttribute("position",new tn(c,3)),this.setAttribute("normal",new tn(l,3)),this.setAttribute("uv",new tn(h,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new n(t.innerRadius,t.outerRadius,t.thetaSegments,t.phiSegments,t.thetaStart,t.thetaLength)}};function Ar(n){let t={};for(let e in n){t[e]={};for(let i in n[e]){let s=n[e][i];if(og(s))s.isRenderTargetTexture?(Kt("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),t[e][i]=null):t[e][i]=s.clone();else if(Array.isArray(s))if(og(s[0])){let r=[];for(let o=0,a=s.length;o<a;o++)r[o]=s[o].clone();t[e][i]=r}else t[e][i]=s.slice();else t[e][i]=s}}return t}function qn(n){let t={};for(let e=0;e<n.length;e++){let i=Ar(n[e]);for(let s in i)t[s]=i[s]}return t}function og(n){return n&&(n.isColor||n.isMatrix3||n.isMatrix4||n.isVector2||n.isVector3||n.isVector4||n.isTexture||n.isQuaternion)}function WS(n){let t=[];for(let e=0;e<n.length;e++)t.push(n[e].clone());return t}function ud(n){let t=n.getRenderTarget();return t===null?n.outputColorSpace:t.isXRRenderTarget===!0?t.texture.colorSpace:ye.workingColorSpace}var Qg={clone:Ar,merge:qn},$S=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,XS=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,Pi=class extends Cs{constructor(t){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=$S,this.fragmentShader=XS,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,t!==void 0&&this.setValues(t)}copy(t){return super.copy(t),this.fragmentShader=t.fragmentShader,this.vertexShader=t.vertexShader,this.uniforms=Ar(t.uniforms),this.uniformsGroups=WS(t.uniformsGroups),this.defines=Object.assign({},t.defines),this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.fog=t.fog,this.lights=t.lights,this.clipping=t.clipping,this.extensions=Object.assign({},t.extensions),this.glslVersion=t.glslVersion,this.defaultAttributeValues=Object.assign({},t.defaultAttributeValues),this.index0AttributeName=t.index0AttributeName,this.uniformsNeedUpdate=t.uniformsNeedUpdate,this}toJSON(t){let e=super.toJSON(t);e.glslVersion=this.glslVersion,e.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?e.uniforms[s]={type:"t",value:o.toJSON(t).uuid}:o&&o.isColor?e.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?e.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?e.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?e.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?e.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?e.uniforms[s]={type:"m4",value:o.toArray()}:e.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(e.defines=this.defines),e.vertexShader=this.vertexShader,e.fragmentShader=this.fragmentShader,e.lights=this.lights,e.clipping=this.clipping;let i={};for(let s in this.extensions)this.extensions[s]===!0&&(i[s]=!0);return Object.keys(i).length>0&&(e.extensions=i),e}fromJSON(t,e){if(super.fromJSON(t,e),t.uniforms!==void 0)for(let i in t.uniforms){let s=t.uniforms[i];switch(this.uniforms[i]={},s.type){case"t":this.uniforms[i].value=e[s.value]||null;break;case"c":this.uniforms[i].value=new ue().setHex(s.value);break;case"v2":this.uniforms[i].value=new jt().fromArray(s.value);break;case"v3":this.uniforms[i].value=new $().fromArray(s.value);break;case"v4":this.uniforms[i].value=new Je().fromArray(s.value);break;case"m3":this.uniforms[i].value=new oe().fromArray(s.value);break;case"m4":this.uniforms[i].value=new Be().fromArray(s.value);break;default:this.uniforms[i].value=s.value}}if(t.defines!==void 0&&(this.defines=t.defines),t.vertexShader!==void 0&&(this.vertexShader=t.vertexShader),t.fragmentShader!==void 0&&(this.fragmentShader=t.fragmentShader),t.glslVersion!==void 0&&(this.glslVersion=t.glslVersion),t.extensions!==void 0)for(let i in t.extensions)this.extensions[i]=t.extensions[i];return t.lights!==void 0&&(this.lights=t.lights),t.clipping!==void 0&&(this.clipping=t.clipping),this}},Ic=class extends Pi{constructor(t){super(t),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}};var Fa=class extends Cs{constructor(t){super(),this.isMeshLambertMaterial=!0,this.type="MeshLambertMaterial",this.color=new ue(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new ue(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=Ph,this.normalScale=new jt(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new As,this.combine=$c,this.reflectivity=1,this.envMapIntensity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.emissive.copy(t.emissive),this.emissiveMap=t.emissiveMap,this.emissiveIntensity=t.emissiveIntensity,this.bumpMap=t.bumpMap,this.bumpScale=t.bumpScale,this.normalMap=t.normalMap,this.normalMapType=t.normalMapType,this.normalScale.copy(t.normalScale),this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.envMapIntensity=t.envMapIntensity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.flatShading=t.flatShading,this.fog=t.fog,this}},Pc=class extends Cs{constructor(t){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=Fg,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(t)}copy(t){return super.copy(t),this.depthPacking=t.depthPacking,this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this}},Lc=class extends Cs{constructor(t){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(t)}copy(t){return super.copy(t),this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this}};function ro(n,t){return!n||n.constructor===t?n:typeof t.BYTES_PER_ELEMENT=="number"?new t(n):Array.prototype.slice.call(n)}function lc(n){return n!==void 0&&n.inTangents!==void 0&&n.outTangents!==void 0}var tr=class{constructor(t,e,i,s){this.parameterPositions=t,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new e.constructor(i),this.sampleValues=e,this.valueSize=i,this.settings=null,this.DefaultSettings_={}}evaluate(t){let e=this.parameterPositions,i=this._cachedIndex,s=e[i],r=e[i-1];n:{t:{let o;e:{i:if(!(t<s)){for(let a=i+2;;){if(s===void 0){if(t<r)break i;return i=e.length,this._cachedIndex=i,this.copySampleValue_(i-1)}if(i===a)break;if(r=s,s=e[++i],t<s)break t}o=e.length;break e}if(!(t>=r)){let a=e[1];t<a&&(i=2,r=a);for(let c=i-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(i===c)break;if(s=r,r=e[--i-1],t>=r)break t}o=i,i=0;break e}break n}for(;i<o;){let a=i+o>>>1;t<e[a]?o=a:i=a+1}if(s=e[i],r=e[i-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return i=e.length,this._cachedIndex=i,this.copySampleValue_(i-1)}this._cachedIndex=i,this.intervalChanged_(i,r,s)}return this.interpolate_(i,r,t,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(t){let e=this.resultBuffer,i=this.sampleValues,s=this.valueSize,r=t*s;for(let o=0;o!==s;++o)e[o]=i[r+o];return e}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},Dc=class extends tr{constructor(t,e,i,s){super(t,e,i,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:Rf,endingEnd:Rf}}intervalChanged_(t,e,i){let s=this.parameterPositions,r=t-2,o=t+1,a=s[r],c=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case If:r=t,a=2*e-i;break;case Pf:r=s.length-2,a=e+s[r]-s[r+1];break;default:r=t,a=i}if(c===void 0)switch(this.getSettings_().endingEnd){case If:o=t,c=2*i-e;break;case Pf:o=1,c=i+s[1]-s[0];break;default:o=t-1,c=e}let l=(i-e)*.5,h=this.valueSize;this._weightPrev=l/(e-a),this._weightNext=l/(c-i),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(t,e,i,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,c=t*a,l=c-a,h=this._offsetPrev,f=this._offsetNext,u=this._weightPrev,d=this._weightNext,p=(i-e)/(s-e),_=p*p,m=_*p,g=-u*m+2*u*_-u*p,v=(1+u)*m+(-1.5-2*u)*_+(-.5+u)*p+1,T=(-1-d)*m+(1.5+d)*_+.5*p,S=d*m-d*_;for(let C=0;C!==a;++C)r[C]=g*o[h+C]+v*o[l+C]+T*o[c+C]+S*o[f+C];return r}},Nc=class extends tr{constructor(t,e,i,s){super(t,e,i,s)}interpolate_(t,e,i,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,c=t*a,l=c-a,h=(i-e)/(s-e),f=1-h;for(let u=0;u!==a;++u)r[u]=o[l+u]*f+o[c+u]*h;return r}},Oc=class extends tr{constructor(t,e,i,s){super(t,e,i,s)}interpolate_(t){return this.copySampleValue_(t-1)}},Uc=class extends tr{interpolate_(t,e,i,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,c=t*a,l=c-a,h=this.inTangents,f=this.outTangents;if(!h||!f){let p=(i-e)/(s-e),_=1-p;for(let m=0;m!==a;++m)r[m]=o[l+m]*_+o[c+m]*p;return r}let u=a*2,d=t-1;for(let p=0;p!==a;++p){let _=o[l+p],m=o[c+p],g=d*u+p*2,v=f[g],T=f[g+1],S=t*u+p*2,C=h[S],E=h[S+1],y=YS(i,e,v,C,s);r[p]=t0(y,_,T,E,m)}return r}};function t0(n,t,e,i,s){let r=1-n;return r*r*r*t+3*r*r*n*e+3*r*n*n*i+n*n*n*s}function qS(n,t,e,i,s){let r=1-n;return 3*r*r*(e-t)+6*r*n*(i-e)+3*n*n*(s-i)}function YS(n,t,e,i,s){let r=(n-t)/(s-t);for(let o=0;o<8;o++){let a=t0(r,t,e,i,s)-n;if(Math.abs(a)<1e-10)break;let c=qS(r,t,e,i,s);if(Math.abs(c)<1e-10)break;r=Math.max(0,Math.min(1,r-a/c))}return r}var Si=class{constructor(t,e,i,s){if(t===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(e===void 0||e.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+t);this.name=t,this.times=ro(e,this.TimeBufferType),this.values=ro(i,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(t){let e=t.constructor,i;if(e.toJSON!==this.toJSON)i=e.toJSON(t);else{i={name:t.name,times:ro(t.times,Array),values:ro(t.values,Array)};let s=t.getInterpolation();s!==t.DefaultInterpolation&&(i.interpolation=s),lc(t.settings)&&(i.settings={inTangents:ro(t.settings.inTangents,Array),outTangents:ro(t.settings.outTangents,Array)})}return i.type=t.ValueTypeName,i}InterpolantFactoryMethodDiscrete(t){return new Oc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodLinear(t){return new Nc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodSmooth(t){return new Dc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodBezier(t){let e=new Uc(this.times,this.values,this.getValueSize(),t);return this.settings&&(e.inTangents=this.settings.inTangents,e.outTangents=this.settings.outTangents),e}setInterpolation(t){let e;switch(t){case Sa:e=this.InterpolantFactoryMethodDiscrete;break;case bc:e=this.InterpolantFactoryMethodLinear;break;case uc:e=this.InterpolantFactoryMethodSmooth;break;case Cf:e=this.InterpolantFactoryMethodBezier;break}if(e===void 0){let i="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(t!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(i);return Kt("KeyframeTrack:",i),this}return this.createInterpolant=e,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return Sa;case this.InterpolantFactoryMethodLinear:return bc;case this.InterpolantFactoryMethodSmooth:return uc;case this.InterpolantFactoryMethodBezier:return Cf}}getValueSize(){return this.values.length/this.times.length}shift(t){if(t!==0){let e=this.times;for(let i=0,s=e.length;i!==s;++i)e[i]+=t;lc(this.settings)&&(ag(this.settings.inTangents,t),ag(this.settings.outTangents,t))}return this}scale(t){if(t!==1){let e=this.times;for(let i=0,s=e.length;i!==s;++i)e[i]*=t;lc(this.settings)&&(lg(this.settings.inTangents,t),lg(this.settings.outTangents,t))}return this}trim(t,e){let i=this.times,s=i.length,r=0,o=s-1;for(;r!==s&&i[r]<t;)++r;for(;o!==-1&&i[o]>e;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=i.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let t=!0,e=this.getValueSize();e-Math.floor(e)!==0&&(re("KeyframeTrack: Invalid value size in track.",this),t=!1);let i=this.times,s=this.values,r=i.length;r===0&&(re("KeyframeTrack: Track is empty.",this),t=!1);let o=null;for(let a=0;a!==r;a++){let c=i[a];if(typeof c=="number"&&isNaN(c)){re("KeyframeTrack: Time is not a valid number.",this,a,c),t=!1;break}if(o!==null&&o>c){re("KeyframeTrack: Out of order keys.",this,a,c,o),t=!1;break}o=c}if(s!==void 0&&hS(s))for(let a=0,c=s.length;a!==c;++a){let l=s[a];if(isNaN(l)){re("KeyframeTrack: Value is not a valid number.",this,a,l),t=!1;break}}return t}optimize(){let t=this.times.slice(),e=this.values.slice(),i=this.getValueSize(),s=this.getInterpolation()===uc,r=t.length-1,o=1;for(let a=1;a<r;++a){let c=!1,l=t[a],h=t[a+1];if(l!==h&&(a!==1||l!==t[0]))if(s)c=!0;else{let f=a*i,u=f-i,d=f+i;for(let p=0;p!==i;++p){let _=e[f+p];if(_!==e[u+p]||_!==e[d+p]){c=!0;break}}}if(c){if(a!==o){t[o]=t[a];let f=a*i,u=o*i;for(let d=0;d!==i;++d)e[u+d]=e[f+d]}++o}}if(r>0){t[o]=t[r];for(let a=r*i,c=o*i,l=0;l!==i;++l)e[c+l]=e[a+l];++o}return o!==t.length?(this.times=t.slice(0,o),this.values=e.slice(0,o*i)):(this.times=t,this.values=e),this}clone(){let t=this.times.slice(),e=this.values.slice(),i=this.constructor,s=new i(this.name,t,e);return s.createInterpolant=this.createInterpolant,lc(this.settings)&&(s.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),s}};function ag(n,t){for(let e=0,i=n.length;e!==i;e+=2)n[e]+=t}function lg(n,t){for(let e=0,i=n.length;e!==i;e+=2)n[e]*=t}Si.prototype.ValueTypeName="";Si.prototype.TimeBufferType=Float32Array;Si.prototype.ValueBufferType=Float32Array;Si.prototype.DefaultInterpolation=bc;var er=class extends Si{constructor(t,e,i){super(t,e,i)}};er.prototype.ValueTypeName="bool";er.prototype.ValueBufferType=Array;er.prototype.DefaultInterpolation=Sa;er.prototype.InterpolantFactoryMethodLinear=void 0;er.prototype.InterpolantFactoryMethodSmooth=void 0;var Fc=class extends Si{constructor(t,e,i,s){super(t,e,i,s)}};Fc.prototype.ValueTypeName="color";var Bc=class extends Si{constructor(t,e,i,s){super(t,e,i,s)}};Bc.prototype.ValueTypeName="number";var kc=class extends tr{constructor(t,e,i,s){super(t,e,i,s)}interpolate_(t,e,i,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,c=(i-e)/(s-e),l=t*a;for(let h=l+a;l!==h;l+=4)kn.slerpFlat(r,0,o,l-a,o,l,c);return r}},Ba=class extends Si{constructor(t,e,i,s){super(t,e,i,s)}InterpolantFactoryMethodLinear(t){return new kc(this.times,this.values,this.getValueSize(),t)}};Ba.prototype.ValueTypeName="quaternion";Ba.prototype.InterpolantFactoryMethodSmooth=void 0;var nr=class extends Si{constructor(t,e,i){super(t,e,i)}};nr.prototype.ValueTypeName="string";nr.prototype.ValueBufferType=Array;nr.prototype.DefaultInterpolation=Sa;nr.prototype.InterpolantFactoryMethodLinear=void 0;nr.prototype.InterpolantFactoryMethodSmooth=void 0;var zc=class extends Si{constructor(t,e,i,s){super(t,e,i,s)}};zc.prototype.ValueTypeName="vector";var Hc=class{constructor(t,e,i){let s=this,r=!1,o=0,a=0,c,l=[];this.onStart=void 0,this.onLoad=t,this.onProgress=e,this.onError=i,this._abortController=null,this.itemStart=function(h){a++,r===!1&&s.onStart!==void 0&&s.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,s.onProgress!==void 0&&s.onProgress(h,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(h){s.onError!==void 0&&s.onError(h)},this.resolveURL=function(h){return h=h.normalize("NFC"),c?c(h):h},this.setURLModifier=function(h){return c=h,this},this.addHandler=function(h,f){return l.push(h,f),this},this.removeHandler=function(h){let f=l.indexOf(h);return f!==-1&&l.splice(f,2),this},this.getHandler=function(h){for(let f=0,u=l.length;f<u;f+=2){let d=l[f],p=l[f+1];if(d.global&&(d.lastIndex=0),d.test(h))return p}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},e0=new Hc,Vc=class{constructor(t){this.manager=t!==void 0?t:e0,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(t,e){let i=this;return new Promise(function(s,r){i.load(t,s,e,r)})}parse(){}setCrossOrigin(t){return this.crossOrigin=t,this}setWithCredentials(t){return this.withCredentials=t,this}setPath(t){return this.path=t,this}setResourcePath(t){return this.resourcePath=t,this}setRequestHeader(t){return this.requestHeader=t,this}setPriority(t){return this.priority=t,this}setCache(t){return this.cache=t,this}abort(){return this}};Vc.DEFAULT_MATERIAL_NAME="__DEFAULT";var ka=class extends zn{static registerNode(t){this.prototype._lightNode=t}constructor(t,e=1){super(),this.isLight=!0,this.type="Light",this.color=new ue(t),this.intensity=e}copy(t,e){return super.copy(t,e),this.color.copy(t.color),this.intensity=t.intensity,this}toJSON(t){let e=super.toJSON(t);return e.object.color=this.color.getHex(),e.object.intensity=this.intensity,e}},za=class extends ka{constructor(t,e,i){super(t,i),this.isHemisphereLight=!0,this.type="HemisphereLight",this.position.copy(zn.DEFAULT_UP),this.updateMatrix(),this.groundColor=new ue(e)}copy(t,e){return super.copy(t,e),this.groundColor.copy(t.groundColor),this}toJSON(t){let e=super.toJSON(t);return e.object.groundColor=this.groundColor.getHex(),e}},Tf=new Be,cg=new $,hg=new $,Gc=class{constructor(t){this.camera=t,this.intensity=1,this.bias=0,this.biasNode=null,this.normalBias=0,this.radius=1,this.blurSamples=8,this.mapSize=new jt(512,512),this.mapType=hi,this.map=null,this.mapPass=null,this.matrix=new Be,this.autoUpdate=!0,this.needsUpdate=!1,this._frustum=new Qs,this._frameExtents=new jt(1,1),this._viewportCount=1,this._viewports=[new Je(0,0,1,1)]}getViewportCount(){return this._viewportCount}getCamera(){return this.camera}getFrustum(){return this._frustum}updateMatrices(t){let e=this.camera;cg.setFromMatrixPosition(t.matrixWorld),e.position.copy(cg),hg.setFromMatrixPosition(t.target.matrixWorld),e.lookAt(hg),e.updateMatrixWorld(),this._updateMatrix(e,this.matrix,this._frustum)}_updateMatrix(t,e,i,s){Tf.multiplyMatrices(t.projectionMatrix,t.matrixWorldInverse),i.setFromProjectionMatrix(Tf,t.coordinateSystem,t.reversedDepth);let r=this._frameExtents,o=s?s.z/r.x:1,a=s?s.w/r.y:1,c=s?s.x/r.x:0,l=s?s.y/r.y:0;t.coordinateSystem===ho||t.reversedDepth?e.set(.5*o,0,0,.5*o+c,0,.5*a,0,.5*a+l,0,0,1,0,0,0,0,1):e.set(.5*o,0,0,.5*o+c,0,.5*a,0,.5*a+l,0,0,.5,.5,0,0,0,1),e.multiply(Tf)}getViewport(t){return this._viewports[t]}getFrameExtents(){return this._frameExtents}dispose(){this.map&&this.map.dispose(),this.mapPass&&this.mapPass.dispose()}copy(t){return this.camera=t.camera.clone(),this.intensity=t.intensity,this.bias=t.bias,this.radius=t.radius,this.autoUpdate=t.autoUpdate,this.needsUpdate=t.needsUpdate,this.normalBias=t.normalBias,this.blurSamples=t.blurSamples,this.mapSize.copy(t.mapSize),this.mapType=t.mapType,this.biasNode=t.biasNode,this}clone(){return new this.constructor().copy(this)}toJSON(){let t={};return t.intensity=this.intensity,t.bias=this.bias,t.normalBias=this.normalBias,t.radius=this.radius,t.blurSamples=this.blurSamples,t.mapSize=this.mapSize.toArray(),t.mapType=this.mapType,t.camera=this.camera.toJSON(!1).object,delete t.camera.matrix,t}},cc=new $,hc=new kn,os=new $,Ha=class extends zn{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new Be,this.projectionMatrix=new Be,this.projectionMatrixInverse=new Be,this.coordinateSystem=Ii,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(t,e){return super.copy(t,e),this.matrixWorldInverse.copy(t.matrixWorldInverse),this.projectionMatrix.copy(t.projectionMatrix),this.projectionMatrixInverse.copy(t.projectionMatrixInverse),this.coordinateSystem=t.coordinateSystem,this}getWorldDirection(t){return super.getWorldDirection(t).negate()}updateMatrixWorld(t){super.updateMatrixWorld(t),this.matrixWorld.decompose(cc,hc,os),os.x===1&&os.y===1&&os.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(cc,hc,os.set(1,1,1)).invert()}updateWorldMatrix(t,e,i=!1){super.updateWorldMatrix(t,e,i),this.matrixWorld.decompose(cc,hc,os),os.x===1&&os.y===1&&os.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(cc,hc,os.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},Js=new $,ug=new jt,fg=new jt,ti=class extends Ha{constructor(t=50,e=1,i=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=t,this.zoom=1,this.near=i,this.far=s,this.focus=10,this.aspect=e,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.fov=t.fov,this.zoom=t.zoom,this.near=t.near,this.far=t.far,this.focus=t.focus,this.aspect=t.aspect,this.view=t.view===null?null:Object.assign({},t.view),this.filmGauge=t.filmGauge,this.filmOffset=t.filmOffset,this}setFocalLength(t){let e=.5*this.getFilmHeight()/t;this.fov=fo*2*Math.atan(e),this.updateProjectionMatrix()}getFocalLength(){let t=Math.tan(xa*.5*this.fov);return .5*this.getFilmHeight()/t}getEffectiveFOV(){return fo*2*Math.atan(Math.tan(xa*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(t,e,i){Js.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),e.set(Js.x,Js.y).multiplyScalar(-t/Js.z),Js.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),i.set(Js.x,Js.y).multiplyScalar(-t/Js.z)}getViewSize(t,e){return this.getViewBounds(t,ug,fg),e.subVectors(fg,ug)}setViewOffset(t,e,i,s,r,o){this.aspect=t/e,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=i,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=this.near,e=t*Math.tan(xa*.5*this.fov)/this.zoom,i=2*e,s=this.aspect*i,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let c=o.fullWidth,l=o.fullHeight;r+=o.offsetX*s/c,e-=o.offsetY*i/l,s*=o.width/c,i*=o.height/l}let a=this.filmOffset;a!==0&&(r+=t*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,e,e-i,t,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.fov=this.fov,e.object.zoom=this.zoom,e.object.near=this.near,e.object.far=this.far,e.object.focus=this.focus,e.object.aspect=this.aspect,this.view!==null&&(e.object.view=Object.assign({},this.view)),e.object.filmGauge=this.filmGauge,e.object.filmOffset=this.filmOffset,e}};var Va=class extends Ha{constructor(t=-1,e=1,i=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=t,this.right=e,this.top=i,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.left=t.left,this.right=t.right,this.top=t.top,this.bottom=t.bottom,this.near=t.near,this.far=t.far,this.zoom=t.zoom,this.view=t.view===null?null:Object.assign({},t.view),this}setViewOffset(t,e,i,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=i,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=(this.right-this.left)/(2*this.zoom),e=(this.top-this.bottom)/(2*this.zoom),i=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=i-t,o=i+t,a=s+e,c=s-e;if(this.view!==null&&this.view.enabled){let l=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=l*this.view.offsetX,o=r+l*this.view.width,a-=h*this.view.offsetY,c=a-h*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,c,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.zoom=this.zoom,e.object.left=this.left,e.object.right=this.right,e.object.top=this.top,e.object.bottom=this.bottom,e.object.near=this.near,e.object.far=this.far,this.view!==null&&(e.object.view=Object.assign({},this.view)),e}},Lf=class extends Gc{constructor(){super(new Va(-5,5,5,-5,.5,500)),this.isDirectionalLightShadow=!0}},Ga=class extends ka{constructor(t,e){super(t,e),this.isDirectionalLight=!0,this.type="DirectionalLight",this.position.copy(zn.DEFAULT_UP),this.updateMatrix(),this.target=new zn,this.shadow=new Lf}dispose(){super.dispose(),this.shadow.dispose()}copy(t){return super.copy(t),this.target=t.target.clone(),this.shadow=t.shadow.clone(),this}toJSON(t){let e=super.toJSON(t);return e.object.shadow=this.shadow.toJSON(),e.object.target=this.target.uuid,e}};var oo=-90,ao=1,bo=class extends zn{constructor(t,e,i){super(),this.type="CubeCamera",this.renderTarget=i,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new ti(oo,ao,t,e);s.layers=this.layers,this.add(s);let r=new ti(oo,ao,t,e);r.layers=this.layers,this.add(r);let o=new ti(oo,ao,t,e);o.layers=this.layers,this.add(o);let a=new ti(oo,ao,t,e);a.layers=this.layers,this.add(a);let c=new ti(oo,ao,t,e);c.layers=this.layers,this.add(c);let l=new ti(oo,ao,t,e);l.layers=this.layers,this.add(l)}updateCoordinateSystem(){let t=this.coordinateSystem,e=this.children.concat(),[i,s,r,o,a,c]=e;for(let l of e)this.remove(l);if(t===Ii)i.up.set(0,1,0),i.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),c.up.set(0,1,0),c.lookAt(0,0,-1);else if(t===ho)i.up.set(0,-1,0),i.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),c.up.set(0,-1,0),c.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+t);for(let l of e)this.add(l),l.updateMatrixWorld()}update(t,e){this.parent===null&&this.updateMatrixWorld();let{renderTarget:i,activeMipmapLevel:s}=this;this.coordinateSystem!==t.coordinateSystem&&(this.coordinateSystem=t.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,c,l,h]=this.children,f=t.getRenderTarget(),u=t.getActiveCubeFace(),d=t.getActiveMipmapLevel(),p=t.xr.enabled;t.xr.enabled=!1;let _=i.texture.mipmapsAutoUpdate;i.texture.mipmapsAutoUpdate=!1;let m=!1;t.isWebGLRenderer===!0?m=t.state.buffers.depth.getReversed():m=t.reversedDepthBuffer,t.setRenderTarget(i,0,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,r),t.setRenderTarget(i,1,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,o),t.setRenderTarget(i,2,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,a),t.setRenderTarget(i,3,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,c),t.setRenderTarget(i,4,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,l),i.texture.mipmapsAutoUpdate=_,t.setRenderTarget(i,5,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,h),t.setRenderTarget(f,u,d),t.xr.enabled=p,i.texture.needsPMREMUpdate=!0}},Wc=class extends ti{constructor(t=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=t,this.perCameraFrustumCulled=!1}};var fd="\\[\\]\\.:\\/",ZS=new RegExp("["+fd+"]","g"),dd="[^"+fd+"]",KS="[^"+fd.replace("\\.","")+"]",JS=/((?:WC+[\/:])*)/.source.replace("WC",dd),jS=/(WCOD+)?/.source.replace("WCOD",KS),QS=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",dd),tb=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",dd),eb=new RegExp("^"+JS+jS+QS+tb+"$"),nb=["material","materials","bones","map"],Df=class{constructor(t,e,i){let s=i||qe.parseTrackName(e);this._targetGroup=t,this._bindings=t.subscribe_(e,s)}getValue(t,e){this.bind();let i=this._targetGroup.nCachedObjects_,s=this._bindings[i];s!==void 0&&s.getValue(t,e)}setValue(t,e){let i=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=i.length;s!==r;++s)i[s].setValue(t,e)}bind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,i=t.length;e!==i;++e)t[e].bind()}unbind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,i=t.length;e!==i;++e)t[e].unbind()}},qe=class n{constructor(t,e,i){this.path=e,this.parsedPath=i||n.parseTrackName(e),this.node=n.findNode(t,this.parsedPath.nodeName),this.rootNode=t,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(t,e,i){return t&&t.isAnimationObjectGroup?new n.Composite(t,e,i):new n(t,e,i)}static sanitizeNodeName(t){return t.replace(/\s/g,"_").replace(ZS,"")}static parseTrackName(t){let e=eb.exec(t);if(e===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+t);let i={nodeName:e[2],objectName:e[3],objectIndex:e[4],propertyName:e[5],propertyIndex:e[6]},s=i.nodeName&&i.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=i.nodeName.substring(s+1);nb.indexOf(r)!==-1&&(i.nodeName=i.nodeName.substring(0,s),i.objectName=r)}if(i.propertyName===null||i.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+t);return i}static findNode(t,e){if(e===void 0||e===""||e==="."||e===-1||e===t.name||e===t.uuid)return t;if(t.skeleton){let i=t.skeleton.getBoneByName(e);if(i!==void 0)return i}if(t.children){let i=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===e||a.uuid===e)return a;let c=i(a.children);if(c)return c}return null},s=i(t.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(t,e){t[e]=this.targetObject[this.propertyName]}_getValue_array(t,e){let i=this.resolvedProperty;for(let s=0,r=i.length;s!==r;++s)t[e++]=i[s]}_getValue_arrayElement(t,e){t[e]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(t,e){this.resolvedProperty.toArray(t,e)}_setValue_direct(t,e){this.targetObject[this.propertyName]=t[e]}_setValue_direct_setNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(t,e){let i=this.resolvedProperty;for(let s=0,r=i.length;s!==r;++s)i[s]=t[e++]}_setValue_array_setNeedsUpdate(t,e){let i=this.resolvedProperty;for(let s=0,r=i.length;s!==r;++s)i[s]=t[e++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(t,e){let i=this.resolvedProperty;for(let s=0,r=i.length;s!==r;++s)i[s]=t[e++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(t,e){this.resolvedProperty[this.propertyIndex]=t[e]}_setValue_arrayElement_setNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(t,e){this.resolvedProperty.fromArray(t,e)}_setValue_fromArray_setNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(t,e){this.bind(),this.getValue(t,e)}_setValue_unbound(t,e){this.bind(),this.setValue(t,e)}bind(){let t=this.node,e=this.parsedPath,i=e.objectName,s=e.propertyName,r=e.propertyIndex;if(t||(t=n.findNode(this.rootNode,e.nodeName),this.node=t),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!t){Kt("PropertyBinding: No target node found for track: "+this.path+".");return}if(i){let l=e.objectIndex;switch(i){case"materials":if(!t.material){re("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.materials){re("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}t=t.material.materials;break;case"bones":if(!t.skeleton){re("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}t=t.skeleton.bones;for(let h=0;h<t.length;h++)if(t[h].name===l){l=h;break}break;case"map":if("map"in t){t=t.map;break}if(!t.material){re("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.map){re("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}t=t.material.map;break;default:if(t[i]===void 0){re("PropertyBinding: Can not bind to objectName of node undefined.",this);return}t=t[i]}if(l!==void 0){if(t[l]===void 0){re("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,t);return}t=t[l]}}let o=t[s];if(o===void 0){let l=e.nodeName;re("PropertyBinding: Trying to update property for track: "+l+"."+s+" but it wasn't found.",t);return}let a=this.Versioning.None;this.targetObject=t,t.isMaterial===!0?a=this.Versioning.NeedsUpdate:t.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let c=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!t.geometry){re("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!t.geometry.morphAttributes){re("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}t.morphTargetDictionary[r]!==void 0&&(r=t.morphTargetDictionary[r])}c=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(c=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(c=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[c],this.setValue=this.SetterByBindingTypeAndVersioning[c][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};qe.Composite=Df;qe.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};qe.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};qe.prototype.GetterByBindingType=[qe.prototype._getValue_direct,qe.prototype._getValue_array,qe.prototype._getValue_arrayElement,qe.prototype._getValue_toArray];qe.prototype.SetterByBindingTypeAndVersioning=[[qe.prototype._setValue_direct,qe.prototype._setValue_direct_setNeedsUpdate,qe.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[qe.prototype._setValue_array,qe.prototype._setValue_array_setNeedsUpdate,qe.prototype._setValue_array_setMatrixWorldNeedsUpdate],[qe.prototype._setValue_arrayElement,qe.prototype._setValue_arrayElement_setNeedsUpdate,qe.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[qe.prototype._setValue_fromArray,qe.prototype._setValue_fromArray_setNeedsUpdate,qe.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var lP=new Float32Array(1);var ir=class{constructor(t=1,e=0,i=0){this.radius=t,this.phi=e,this.theta=i}set(t,e,i){return this.radius=t,this.phi=e,this.theta=i,this}copy(t){return this.radius=t.radius,this.phi=t.phi,this.theta=t.theta,this}makeSafe(){return this.phi=me(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(t){return this.setFromCartesianCoords(t.x,t.y,t.z)}setFromCartesianCoords(t,e,i){return this.radius=Math.sqrt(t*t+e*e+i*i),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(t,i),this.phi=Math.acos(me(e/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var Nf=class{static{this.prototype.isMatrix2=!0}constructor(t,e,i,s){this.elements=[1,0,0,1],t!==void 0&&this.set(t,e,i,s)}identity(){return this.set(1,0,0,1),this}fromArray(t,e=0){for(let i=0;i<4;i++)this.elements[i]=t[i+e];return this}set(t,e,i,s){let r=this.elements;return r[0]=t,r[2]=e,r[1]=i,r[3]=s,this}};var Wa=class extends Vi{constructor(t,e=null){super(),this.object=t,this.domElement=e,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(t){this.domElement!==null&&this.disconnect(),this.domElement=t}disconnect(){}dispose(){}update(){}};function pd(n,t,e,i){let s=ib(i);switch(e){case Qf:return n*t;case ed:return n*t/s.components*s.byteLength;case jc:return n*t/s.components*s.byteLength;case ar:return n*t*2/s.components*s.byteLength;case Qc:return n*t*2/s.components*s.byteLength;case td:return n*t*3/s.components*s.byteLength;case Xi:return n*t*4/s.components*s.byteLength;case th:return n*t*4/s.components*s.byteLength;case qa:case Ya:return Math.floor((n+3)/4)*Math.floor((t+3)/4)*8;case Za:case Ka:return Math.floor((n+3)/4)*Math.floor((t+3)/4)*16;case nh:case sh:return Math.max(n,16)*Math.max(t,8)/4;case eh:case ih:return Math.max(n,8)*Math.max(t,8)/2;case rh:case oh:case lh:case ch:return Math.floor((n+3)/4)*Math.floor((t+3)/4)*8;case ah:case Ja:case hh:return Math.floor((n+3)/4)*Math.floor((t+3)/4)*16;case uh:return Math.floor((n+3)/4)*Math.floor((t+3)/4)*16;case fh:return Math.floor((n+4)/5)*Math.floor((t+3)/4)*16;case dh:return Math.floor((n+4)/5)*Math.floor((t+4)/5)*16;case ph:return Math.floor((n+5)/6)*Math.floor((t+4)/5)*16;case mh:return Math.floor((n+5)/6)*Math.floor((t+5)/6)*16;case gh:return Math.floor((n+7)/8)*Math.floor((t+4)/5)*16;case _h:return Math.floor((n+7)/8)*Math.floor((t+5)/6)*16;case yh:return Math.floor((n+7)/8)*Math.floor((t+7)/8)*16;case xh:return Math.floor((n+9)/10)*Math.floor((t+4)/5)*16;case vh:return Math.floor((n+9)/10)*Math.floor((t+5)/6)*16;case Sh:return Math.floor((n+9)/10)*Math.floor((t+7)/8)*16;case bh:return Math.floor((n+9)/10)*Math.floor((t+9)/10)*16;case wh:return Math.floor((n+11)/12)*Math.floor((t+9)/10)*16;case Mh:return Math.floor((n+11)/12)*Math.floor((t+11)/12)*16;case Eh:case Ah:case Th:return Math.ceil(n/4)*Math.ceil(t/4)*16;case Ch:case Rh:return Math.ceil(n/4)*Math.ceil(t/4)*8;case ja:case Ih:return Math.ceil(n/4)*Math.ceil(t/4)*16}throw new Error(`Unable to determine texture byte length for ${e} format.`)}function ib(n){switch(n){case hi:case Zf:return{byteLength:1,components:1};case Ao:case Kf:case $i:return{byteLength:2,components:1};case Kc:case Jc:return{byteLength:2,components:4};case Gi:case Zc:case Wi:return{byteLength:4,components:1};case Jf:case jf:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${n}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?Kt("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");function w0(){let n=null,t=!1,e=null,i=null;function s(r,o){i=n.requestAnimationFrame(s),e(r,o)}return{start:function(){t!==!0&&e!==null&&n!==null&&(i=n.requestAnimationFrame(s),t=!0)},stop:function(){n!==null&&n.cancelAnimationFrame(i),t=!1},setAnimationLoop:function(r){e=r},setContext:function(r){n=r}}}function rb(n){let t=new WeakMap;function e(a,c){let l=a.array,h=a.usage,f=l.byteLength,u=n.createBuffer();n.bindBuffer(c,u),n.bufferData(c,l,h),a.onUploadCallback();let d;if(l instanceof Float32Array)d=n.FLOAT;else if(typeof Float16Array<"u"&&l instanceof Float16Array)d=n.HALF_FLOAT;else if(l instanceof Uint16Array)a.isFloat16BufferAttribute?d=n.HALF_FLOAT:d=n.UNSIGNED_SHORT;else if(l instanceof Int16Array)d=n.SHORT;else if(l instanceof Uint32Array)d=n.UNSIGNED_INT;else if(l instanceof Int32Array)d=n.INT;else if(l instanceof Int8Array)d=n.BYTE;else if(l instanceof Uint8Array)d=n.UNSIGNED_BYTE;else if(l instanceof Uint8ClampedArray)d=n.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+l);return{buffer:u,type:d,bytesPerElement:l.BYTES_PER_ELEMENT,version:a.version,size:f}}function i(a,c,l){let h=c.array,f=c.updateRanges;if(n.bindBuffer(l,a),f.length===0)n.bufferSubData(l,0,h);else{f.sort((d,p)=>d.start-p.start);let u=0;for(let d=1;d<f.length;d++){let p=f[u],_=f[d];_.start<=p.start+p.count+1?p.count=Math.max(p.count,_.start+_.count-p.start):(++u,f[u]=_)}f.length=u+1;for(let d=0,p=f.length;d<p;d++){let _=f[d];n.bufferSubData(l,_.start*h.BYTES_PER_ELEMENT,h,_.start,_.count)}c.clearUpdateRanges()}c.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),t.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let c=t.get(a);c&&(n.deleteBuffer(c.buffer),t.delete(a))}function o(a,c){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let h=t.get(a);(!h||h.version<a.version)&&t.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let l=t.get(a);if(l===void 0)t.set(a,e(a,c));else if(l.version<a.version){if(l.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");i(l.buffer,a,c),l.version=a.version}}return{get:s,remove:r,update:o}}var ob=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,ab=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,lb=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,cb=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,hb=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,ub=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,fb=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,db=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,pb=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,mb=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,gb=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,_b=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,yb=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,xb=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,vb=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,Sb=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,bb=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,wb=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,Mb=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,Eb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,Ab=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,Tb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,Cb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,Rb=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,Ib=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,Pb=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,Lb=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,Db=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,Nb=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,Ob="gl_FragColor = linearToOutputTexel( gl_FragColor );",Ub=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,Fb=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,Bb=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,kb=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,zb=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,Hb=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,Vb=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,Gb=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,Wb=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,$b=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,Xb=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,qb=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,Yb=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,Zb=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,Kb=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,Jb=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,jb=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,Qb=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,tw=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,ew=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,nw=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,iw=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,sw=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,rw=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,ow=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,aw=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,lw=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,cw=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,hw=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,uw=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,fw=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,dw=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,pw=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,mw=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,gw=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,_w=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,yw=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,xw=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,vw=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,Sw=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,bw=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,ww=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,Mw=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,Ew=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,Aw=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,Tw=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,Cw=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,Rw=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,Iw=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,Pw=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,Lw=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,Dw=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,Nw=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,Ow=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,Uw=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,Fw=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,Bw=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,kw=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,zw=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,Hw=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,Vw=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,Gw=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,Ww=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,$w=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,Xw=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,qw=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,Yw=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,Zw=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,Kw=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,Jw=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,jw=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,Qw=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,tM=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,eM=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,nM=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,iM=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,sM=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,rM=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,oM=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,aM=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,lM=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,cM=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,hM=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,uM=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,fM=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,dM=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,pM=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,mM=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,gM=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,_M=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,yM=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,xM=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,vM=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,SM=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,bM=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,wM=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,MM=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,EM=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,AM=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,TM=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,CM=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,RM=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,IM=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,PM=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,LM=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,DM=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,NM=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,OM=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,UM=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,FM=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,BM=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,fe={alphahash_fragment:ob,alphahash_pars_fragment:ab,alphamap_fragment:lb,alphamap_pars_fragment:cb,alphatest_fragment:hb,alphatest_pars_fragment:ub,aomap_fragment:fb,aomap_pars_fragment:db,batching_pars_vertex:pb,batching_vertex:mb,begin_vertex:gb,beginnormal_vertex:_b,bsdfs:yb,iridescence_fragment:xb,bumpmap_pars_fragment:vb,clipping_planes_fragment:Sb,clipping_planes_pars_fragment:bb,clipping_planes_pars_vertex:wb,clipping_planes_vertex:Mb,color_fragment:Eb,color_pars_fragment:Ab,color_pars_vertex:Tb,color_vertex:Cb,common:Rb,defaultnormal_vertex:Ib,displacementmap_pars_vertex:Pb,displacementmap_vertex:Lb,emissivemap_fragment:Db,emissivemap_pars_fragment:Nb,colorspace_fragment:Ob,colorspace_pars_fragment:Ub,envmap_fragment:Fb,envmap_common_pars_fragment:Bb,envmap_pars_fragment:kb,envmap_pars_vertex:zb,envmap_physical_pars_fragment:Jb,envmap_vertex:Hb,fog_vertex:Vb,fog_pars_vertex:Gb,fog_fragment:Wb,fog_pars_fragment:$b,gradientmap_pars_fragment:Xb,lightmap_pars_fragment:qb,lights_lambert_fragment:Yb,lights_lambert_pars_fragment:Zb,lights_pars_begin:Kb,lights_toon_fragment:jb,lights_toon_pars_fragment:Qb,lights_phong_fragment:tw,lights_phong_pars_fragment:ew,lights_physical_fragment:nw,lights_physical_pars_fragment:iw,lights_fragment_begin:sw,lights_fragment_maps:rw,lights_fragment_end:ow,lightprobes_pars_fragment:aw,logdepthbuf_fragment:lw,logdepthbuf_pars_fragment:cw,logdepthbuf_pars_vertex:hw,logdepthbuf_vertex:uw,map_fragment:fw,map_pars_fragment:dw,map_particle_fragment:pw,map_particle_pars_fragment:mw,metalnessmap_fragment:gw,metalnessmap_pars_fragment:_w,morphinstance_vertex:yw,morphcolor_vertex:xw,morphnormal_vertex:vw,morphtarget_pars_vertex:Sw,morphtarget_vertex:bw,normal_fragment_begin:ww,normal_fragment_maps:Mw,normal_pars_fragment:Ew,normal_pars_vertex:Aw,normal_vertex:Tw,normalmap_pars_fragment:Cw,clearcoat_normal_fragment_begin:Rw,clearcoat_normal_fragment_maps:Iw,clearcoat_pars_fragment:Pw,iridescence_pars_fragment:Lw,opaque_fragment:Dw,packing:Nw,premultiplied_alpha_fragment:Ow,project_vertex:Uw,dithering_fragment:Fw,dithering_pars_fragment:Bw,roughnessmap_fragment:kw,roughnessmap_pars_fragment:zw,shadowmap_pars_fragment:Hw,shadowmap_pars_vertex:Vw,shadowmap_vertex:Gw,shadowmask_pars_fragment:Ww,skinbase_vertex:$w,skinning_pars_vertex:Xw,skinning_vertex:qw,skinnormal_vertex:Yw,specularmap_fragment:Zw,specularmap_pars_fragment:Kw,tonemapping_fragment:Jw,tonemapping_pars_fragment:jw,transmission_fragment:Qw,transmission_pars_fragment:tM,uv_pars_fragment:eM,uv_pars_vertex:nM,uv_vertex:iM,worldpos_vertex:sM,background_vert:rM,background_frag:oM,backgroundCube_vert:aM,backgroundCube_frag:lM,cube_vert:cM,cube_frag:hM,depth_vert:uM,depth_frag:fM,distance_vert:dM,distance_frag:pM,equirect_vert:mM,equirect_frag:gM,linedashed_vert:_M,linedashed_frag:yM,meshbasic_vert:xM,meshbasic_frag:vM,meshlambert_vert:SM,meshlambert_frag:bM,meshmatcap_vert:wM,meshmatcap_frag:MM,meshnormal_vert:EM,meshnormal_frag:AM,meshphong_vert:TM,meshphong_frag:CM,meshphysical_vert:RM,meshphysical_frag:IM,meshtoon_vert:PM,meshtoon_frag:LM,points_vert:DM,points_frag:NM,shadow_vert:OM,shadow_frag:UM,sprite_vert:FM,sprite_frag:BM},Dt={common:{diffuse:{value:new ue(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new oe},alphaMap:{value:null},alphaMapTransform:{value:new oe},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new oe}},envmap:{envMap:{value:null},envMapRotation:{value:new oe},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new oe}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new oe}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new oe},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new oe},normalScale:{value:new jt(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new oe},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new oe}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new oe}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new oe}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new ue(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new ue(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new oe},alphaTest:{value:0},uvTransform:{value:new oe}},sprite:{diffuse:{value:new ue(16777215)},opacity:{value:1},center:{value:new jt(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new oe},alphaMap:{value:null},alphaMapTransform:{value:new oe},alphaTest:{value:0}}},us={basic:{uniforms:qn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.fog]),vertexShader:fe.meshbasic_vert,fragmentShader:fe.meshbasic_frag},lambert:{uniforms:qn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,Dt.lights,{emissive:{value:new ue(0)},envMapIntensity:{value:1}}]),vertexShader:fe.meshlambert_vert,fragmentShader:fe.meshlambert_frag},phong:{uniforms:qn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,Dt.lights,{emissive:{value:new ue(0)},specular:{value:new ue(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:fe.meshphong_vert,fragmentShader:fe.meshphong_frag},standard:{uniforms:qn([Dt.common,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.roughnessmap,Dt.metalnessmap,Dt.fog,Dt.lights,{emissive:{value:new ue(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:fe.meshphysical_vert,fragmentShader:fe.meshphysical_frag},toon:{uniforms:qn([Dt.common,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.gradientmap,Dt.fog,Dt.lights,{emissive:{value:new ue(0)}}]),vertexShader:fe.meshtoon_vert,fragmentShader:fe.meshtoon_frag},matcap:{uniforms:qn([Dt.common,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,{matcap:{value:null}}]),vertexShader:fe.meshmatcap_vert,fragmentShader:fe.meshmatcap_frag},points:{uniforms:qn([Dt.points,Dt.fog]),vertexShader:fe.points_vert,fragmentShader:fe.points_frag},dashed:{uniforms:qn([Dt.common,Dt.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:fe.linedashed_vert,fragmentShader:fe.linedashed_frag},depth:{uniforms:qn([Dt.common,Dt.displacementmap]),vertexShader:fe.depth_vert,fragmentShader:fe.depth_frag},normal:{uniforms:qn([Dt.common,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,{opacity:{value:1}}]),vertexShader:fe.meshnormal_vert,fragmentShader:fe.meshnormal_frag},sprite:{uniforms:qn([Dt.sprite,Dt.fog]),vertexShader:fe.sprite_vert,fragmentShader:fe.sprite_frag},background:{uniforms:{uvTransform:{value:new oe},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:fe.background_vert,fragmentShader:fe.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new oe}},vertexShader:fe.backgroundCube_vert,fragmentShader:fe.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:fe.cube_vert,fragmentShader:fe.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:fe.equirect_vert,fragmentShader:fe.equirect_frag},distance:{uniforms:qn([Dt.common,Dt.displacementmap,{referencePosition:{value:new $},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:fe.distance_vert,fragmentShader:fe.distance_frag},shadow:{uniforms:qn([Dt.lights,Dt.fog,{color:{value:new ue(0)},opacity:{value:1}}]),vertexShader:fe.shadow_vert,fragmentShader:fe.shadow_frag}};us.physical={uniforms:qn([us.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new oe},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new oe},clearcoatNormalScale:{value:new jt(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new oe},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new oe},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new oe},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new oe},sheen:{value:0},sheenColor:{value:new ue(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new oe},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new oe},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new oe},transmissionSamplerSize:{value:new jt},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new oe},attenuationDistance:{value:0},attenuationColor:{value:new ue(0)},specularColor:{value:new ue(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new oe},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new oe},anisotropyVector:{value:new jt},anisotropyMap:{value:null},anisotropyMapTransform:{value:new oe}}]),vertexShader:fe.meshphysical_vert,fragmentShader:fe.meshphysical_frag};var Lh={r:0,b:0,g:0},kM=new Be,M0=new oe;M0.set(-1,0,0,0,1,0,0,0,1);function zM(n,t,e,i,s,r){let o=new ue(0),a=s===!0?0:1,c,l,h=null,f=0,u=null;function d(v){let T=v.isScene===!0?v.background:null;if(T&&T.isTexture){let S=v.backgroundBlurriness>0;T=t.get(T,S)}return T}function p(v){let T=!1,S=d(v);S===null?m(o,a):S&&S.isColor&&(m(S,1),T=!0);let C=n.xr.getEnvironmentBlendMode();C==="additive"?e.buffers.color.setClear(0,0,0,1,r):C==="alpha-blend"&&e.buffers.color.setClear(0,0,0,0,r),(n.autoClear||T)&&(e.buffers.depth.setTest(!0),e.buffers.depth.setMask(!0),e.buffers.color.setMask(!0),n.clear(n.autoClearColor,n.autoClearDepth,n.autoClearStencil))}function _(v,T){let S=d(T);S&&S.isCubeTexture?(l===void 0&&(l=new ni(new xo(1,1,1),new Pi({name:"BackgroundCubeMaterial",uniforms:Ar(us.backgroundCube.uniforms),vertexShader:us.backgroundCube.vertexShader,fragmentShader:us.backgroundCube.fragmentShader,side:ii,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),l.geometry.deleteAttribute("uv"),l.onBeforeRender=function(C,E,y){this.matrixWorld.copyPosition(y.matrixWorld)},Object.defineProperty(l.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),i.update(l)),l.material.uniforms.envMap.value=S,l.material.uniforms.backgroundBlurriness.value=T.backgroundBlurriness,l.material.uniforms.backgroundIntensity.value=T.backgroundIntensity,l.material.uniforms.backgroundRotation.value.setFromMatrix4(kM.makeRotationFromEuler(T.backgroundRotation)).transpose(),S.isRenderTargetTexture===!1&&l.material.uniforms.backgroundRotation.value.premultiply(M0),l.material.toneMapped=ye.getTransfer(S.colorSpace)!==Ie,(h!==S||f!==S.version||u!==n.toneMapping)&&(l.material.needsUpdate=!0,h=S,f=S.version,u=n.toneMapping),l.layers.enableAll(),v.unshift(l,l.geometry,l.material,0,0,null)):S&&S.isTexture&&(c===void 0&&(c=new ni(new Ua(2,2),new Pi({name:"BackgroundMaterial",uniforms:Ar(us.background.uniforms),vertexShader:us.background.vertexShader,fragmentShader:us.background.fragmentShader,side:or,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),Object.defineProperty(c.material,"map",{get:function(){return this.uniforms.t2D.value}}),i.update(c)),c.material.uniforms.t2D.value=S,c.material.uniforms.backgroundIntensity.value=T.backgroundIntensity,c.material.toneMapped=ye.getTransfer(S.colorSpace)!==Ie,S.matrixAutoUpdate===!0&&S.updateMatrix(),c.material.uniforms.uvTransform.value.copy(S.matrix),(h!==S||f!==S.version||u!==n.toneMapping)&&(c.material.needsUpdate=!0,h=S,f=S.version,u=n.toneMapping),c.layers.enableAll(),v.unshift(c,c.geometry,c.material,0,0,null))}function m(v,T){v.getRGB(Lh,ud(n)),e.buffers.color.setClear(Lh.r,Lh.g,Lh.b,T,r)}function g(){l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0),c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0)}return{getClearColor:function(){return o},setClearColor:function(v,T=1){o.set(v),a=T,m(o,a)},getClearAlpha:function(){return a},setClearAlpha:function(v){a=v,m(o,a)},render:p,addToRenderList:_,dispose:g}}function HM(n,t){let e=n.getParameter(n.MAX_VERTEX_ATTRIBS),i={},s=u(null),r=s,o=!1;function a(L,B,F,R,U){let X=!1,G=f(L,R,F,B);r!==G&&(r=G,l(r.object)),X=d(L,R,F,U),X&&p(L,R,F,U),U!==null&&t.update(U,n.ELEMENT_ARRAY_BUFFER),(X||o)&&(o=!1,S(L,B,F,R),U!==null&&n.bindBuffer(n.ELEMENT_ARRAY_BUFFER,t.get(U).buffer))}function c(){return n.createVertexArray()}function l(L){return n.bindVertexArray(L)}function h(L){return n.deleteVertexArray(L)}function f(L,B,F,R){let U=R.wireframe===!0,X=i[B.id];X===void 0&&(X={},i[B.id]=X);let G=L.isInstancedMesh===!0?L.id:0,ct=X[G];ct===void 0&&(ct={},X[G]=ct);let I=ct[F.id];I===void 0&&(I={},ct[F.id]=I);let k=I[U];return k===void 0&&(k=u(c()),I[U]=k),k}function u(L){let B=[],F=[],R=[];for(let U=0;U<e;U++)B[U]=0,F[U]=0,R[U]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:B,enabledAttributes:F,attributeDivisors:R,object:L,attributes:{},index:null}}function d(L,B,F,R){let U=r.attributes,X=B.attributes,G=0,ct=F.getAttributes();for(let I in ct)if(ct[I].location>=0){let Y=U[I],et=X[I];if(et===void 0&&(I==="instanceMatrix"&&L.instanceMatrix&&(et=L.instanceMatrix),I==="instanceColor"&&L.instanceColor&&(et=L.instanceColor)),Y===void 0||Y.attribute!==et||et&&Y.data!==et.data)return!0;G++}return r.attributesNum!==G||r.index!==R}function p(L,B,F,R){let U={},X=B.attributes,G=0,ct=F.getAttributes();for(let I in ct)if(ct[I].location>=0){let Y=X[I];Y===void 0&&(I==="instanceMatrix"&&L.instanceMatrix&&(Y=L.instanceMatrix),I==="instanceColor"&&L.instanceColor&&(Y=L.instanceColor));let et={};et.attribute=Y,Y&&Y.data&&(et.data=Y.data),U[I]=et,G++}r.attributes=U,r.attributesNum=G,r.index=R}function _(){let L=r.newAttributes;for(let B=0,F=L.length;B<F;B++)L[B]=0}function m(L){g(L,0)}function g(L,B){let F=r.newAttributes,R=r.enabledAttributes,U=r.attributeDivisors;F[L]=1,R[L]===0&&(n.enableVertexAttribArray(L),R[L]=1),U[L]!==B&&(n.vertexAttribDivisor(L,B),U[L]=B)}function v(){let L=r.newAttributes,B=r.enabledAttributes;for(let F=0,R=B.length;F<R;F++)B[F]!==L[F]&&(n.disableVertexAttribArray(F),B[F]=0)}function T(L,B,F,R,U,X,G){G===!0?n.vertexAttribIPointer(L,B,F,U,X):n.vertexAttribPointer(L,B,F,R,U,X)}function S(L,B,F,R){_();let U=R.attributes,X=F.getAttributes(),G=B.defaultAttributeValues;for(let ct in X){let I=X[ct];if(I.location>=0){let k=U[ct];if(k===void 0&&(ct==="instanceMatrix"&&L.instanceMatrix&&(k=L.instanceMatrix),ct==="instanceColor"&&L.instanceColor&&(k=L.instanceColor)),k!==void 0){let Y=k.normalized,et=k.itemSize,nt=t.get(k);if(nt===void 0)continue;let Z=nt.buffer,at=nt.type,ut=nt.bytesPerElement,dt=at===n.INT||at===n.UNSIGNED_INT||k.gpuType===Zc;if(k.isInterleavedBufferAttribute){let ot=k.data,Lt=ot.isInterleavedBuffer===!0?ot.stride:ot.itemSize,Zt=k.offset;if(ot.isInstancedInterleavedBuffer||ot.isInstancedBufferAttribute){for(let Ut=0;Ut<I.locationSize;Ut++)g(I.location+Ut,ot.meshPerAttribute);L.isInstancedMesh!==!0&&R._maxInstanceCount===void 0&&(R._maxInstanceCount=ot.meshPerAttribute*ot.count)}else for(let Ut=0;Ut<I.locationSize;Ut++)m(I.location+Ut);n.bindBuffer(n.ARRAY_BUFFER,Z);for(let Ut=0;Ut<I.locationSize;Ut++)T(I.location+Ut,et/I.locationSize,at,Y,Lt*ut,(Zt+et/I.locationSize*Ut)*ut,dt)}else{if(k.isInstancedBufferAttribute){for(let ot=0;ot<I.locationSize;ot++)g(I.location+ot,k.meshPerAttribute);L.isInstancedMesh!==!0&&R._maxInstanceCount===void 0&&(R._maxInstanceCount=k.meshPerAttribute*k.count)}else for(let ot=0;ot<I.locationSize;ot++)m(I.location+ot);n.bindBuffer(n.ARRAY_BUFFER,Z);for(let ot=0;ot<I.locationSize;ot++)T(I.location+ot,et/I.locationSize,at,Y,et*ut,et/I.locationSize*ot*ut,dt)}}else if(G!==void 0){let Y=G[ct];if(Y!==void 0)switch(Y.length){case 2:n.vertexAttrib2fv(I.location,Y);break;case 3:n.vertexAttrib3fv(I.location,Y);break;case 4:n.vertexAttrib4fv(I.location,Y);break;default:n.vertexAttrib1fv(I.location,Y)}}}}v()}function C(){V();for(let L in i){let B=i[L];for(let F in B){let R=B[F];for(let U in R){let X=R[U];for(let G in X)h(X[G].object),delete X[G];delete R[U]}}delete i[L]}}function E(L){if(i[L.id]===void 0)return;let B=i[L.id];for(let F in B){let R=B[F];for(let U in R){let X=R[U];for(let G in X)h(X[G].object),delete X[G];delete R[U]}}delete i[L.id]}function y(L){for(let B in i){let F=i[B];for(let R in F){let U=F[R];if(U[L.id]===void 0)continue;let X=U[L.id];for(let G in X)h(X[G].object),delete X[G];delete U[L.id]}}}function w(L){for(let B in i){let F=i[B],R=L.isInstancedMesh===!0?L.id:0,U=F[R];if(U!==void 0){for(let X in U){let G=U[X];for(let ct in G)h(G[ct].object),delete G[ct];delete U[X]}delete F[R],Object.keys(F).length===0&&delete i[B]}}}function V(){N(),o=!0,r!==s&&(r=s,l(r.object))}function N(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:V,resetDefaultState:N,dispose:C,releaseStatesOfGeometry:E,releaseStatesOfObject:w,releaseStatesOfProgram:y,initAttributes:_,enableAttribute:m,disableUnusedAttributes:v}}function VM(n,t,e){let i;function s(c){i=c}function r(c,l){n.drawArrays(i,c,l),e.update(l,i,1)}function o(c,l,h){h!==0&&(n.drawArraysInstanced(i,c,l,h),e.update(l,i,h))}function a(c,l,h){if(h===0)return;t.get("WEBGL_multi_draw").multiDrawArraysWEBGL(i,c,0,l,0,h);let u=0;for(let d=0;d<h;d++)u+=l[d];e.update(u,i,1)}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a}function GM(n,t,e,i){let s;function r(){if(s!==void 0)return s;if(t.has("EXT_texture_filter_anisotropic")===!0){let y=t.get("EXT_texture_filter_anisotropic");s=n.getParameter(y.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(y){return!(y!==Xi&&i.convert(y)!==n.getParameter(n.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(y){let w=y===$i&&(t.has("EXT_color_buffer_half_float")||t.has("EXT_color_buffer_float"));return!(y!==hi&&y!==Wi&&!w&&i.convert(y)!==n.getParameter(n.IMPLEMENTATION_COLOR_READ_TYPE))}function c(y){if(y==="highp"){if(n.getShaderPrecisionFormat(n.VERTEX_SHADER,n.HIGH_FLOAT).precision>0&&n.getShaderPrecisionFormat(n.FRAGMENT_SHADER,n.HIGH_FLOAT).precision>0)return"highp";y="mediump"}return y==="mediump"&&n.getShaderPrecisionFormat(n.VERTEX_SHADER,n.MEDIUM_FLOAT).precision>0&&n.getShaderPrecisionFormat(n.FRAGMENT_SHADER,n.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let l=e.precision!==void 0?e.precision:"highp",h=c(l);h!==l&&(Kt("WebGLRenderer:",l,"not supported, using",h,"instead."),l=h);let f=e.reversedDepthBuffer===!0&&t.has("EXT_clip_control"),u=e.logarithmicDepthBuffer===!0&&f===!1;e.reversedDepthBuffer===!0&&f===!1&&Kt("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),e.logarithmicDepthBuffer===!0&&f===!0&&Kt("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");let d=n.getParameter(n.MAX_TEXTURE_IMAGE_UNITS),p=n.getParameter(n.MAX_VERTEX_TEXTURE_IMAGE_UNITS),_=n.getParameter(n.MAX_TEXTURE_SIZE),m=n.getParameter(n.MAX_CUBE_MAP_TEXTURE_SIZE),g=n.getParameter(n.MAX_VERTEX_ATTRIBS),v=n.getParameter(n.MAX_VERTEX_UNIFORM_VECTORS),T=n.getParameter(n.MAX_VARYING_VECTORS),S=n.getParameter(n.MAX_FRAGMENT_UNIFORM_VECTORS),C=n.getParameter(n.MAX_SAMPLES),E=n.getParameter(n.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:c,textureFormatReadable:o,textureTypeReadable:a,precision:l,logarithmicDepthBuffer:u,reversedDepthBuffer:f,maxTextures:d,maxVertexTextures:p,maxTextureSize:_,maxCubemapSize:m,maxAttributes:g,maxVertexUniforms:v,maxVaryings:T,maxFragmentUniforms:S,maxSamples:C,samples:E}}function WM(n){let t=this,e=null,i=0,s=!1,r=!1,o=new xi,a=new oe,c={value:null,needsUpdate:!1};this.uniform=c,this.numPlanes=0,this.numIntersection=0,this.init=function(f,u){let d=f.length!==0||u||i!==0||s;return s=u,i=f.length,d},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(f,u){e=h(f,u,0)},this.setState=function(f,u,d){let p=f.clippingPlanes,_=f.clipIntersection,m=f.clipShadows,g=n.get(f);if(!s||p===null||p.length===0||r&&!m)r?h(null):l();else{let v=r?0:i,T=v*4,S=g.clippingState||null;c.value=S,S=h(p,u,T,d);for(let C=0;C!==T;++C)S[C]=e[C];g.clippingState=S,this.numIntersection=_?this.numPlanes:0,this.numPlanes+=v}};function l(){c.value!==e&&(c.value=e,c.needsUpdate=i>0),t.numPlanes=i,t.numIntersection=0}function h(f,u,d,p){let _=f!==null?f.length:0,m=null;if(_!==0){if(m=c.value,p!==!0||m===null){let g=d+_*4,v=u.matrixWorldInverse;a.getNormalMatrix(v),(m===null||m.length<g)&&(m=new Float32Array(g));for(let T=0,S=d;T!==_;++T,S+=4)o.copy(f[T]).applyMatrix4(v,a),o.normal.toArray(m,S),m[S+3]=o.constant}c.value=m,c.needsUpdate=!0}return t.numPlanes=_,t.numIntersection=0,m}}var el=class extends vi{constructor(t=1,e={}){super(t,t,e),this.isWebGLCubeRenderTarget=!0;let i={width:t,height:t,depth:1},s=[i,i,i,i,i,i];this.texture=new Pa(s),this._setTextureOptions(e),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(t,e){this.texture.type=e.type,this.texture.colorSpace=e.colorSpace,this.texture.generateMipmaps=e.generateMipmaps,this.texture.minFilter=e.minFilter,this.texture.magFilter=e.magFilter;let i={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},s=new xo(5,5,5),r=new Pi({name:"CubemapFromEquirect",uniforms:Ar(i.uniforms),vertexShader:i.vertexShader,fragmentShader:i.fragmentShader,side:ii,blending:br});r.uniforms.tEquirect.value=e;let o=new ni(s,r),a=e.minFilter;return e.minFilter===Is&&(e.minFilter=Bn),new bo(1,10,this).update(t,o),e.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(t,e=!0,i=!0,s=!0){let r=t.getRenderTarget();for(let o=0;o<6;o++)t.setRenderTarget(this,o),t.clear(e,i,s);t.setRenderTarget(r)}},n0=256,$M=3,XM=20,E0=256,A0=16,qM=3,YM=new $,ZM=new ue,Nh=class n{constructor(t){this._renderer=t,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new bo(1,10,null),this._boxMesh=new ni(new xo(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(t,e=0,i=.1,s=100,r={}){let{size:o=256,position:a=YM}=r,c=this._renderer;this._setSize(o);let l=this._allocateTarget(),h=this._getSourceTarget(!0);e>0&&(h.texture.mipmapsAutoUpdate=!1);let f=c.autoClear,u=c.autoClearColor,d=c.autoClearDepth,p=c.autoClearStencil,_=t.background;c.autoClear=!0,c.autoClearColor=!0,c.autoClearDepth=!0,c.autoClearStencil=!0,_===null&&(t.background=c.getClearColor(ZM));let m=new bo(i,s,h);return m.position.copy(a),m.update(c,t),c.autoClear=f,c.autoClearColor=u,c.autoClearDepth=d,c.autoClearStencil=p,t.background=_,e>0&&(h.texture.mipmapsAutoUpdate=!0,this._blur(l,e)),this._applyPMREM(l),l}fromEquirectangular(t,e=null){return this._fromTexture(t,e)}fromCubemap(t,e=null){return this._fromTexture(t,e)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=r0(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=s0(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(t,e){return e>0?1-Math.sqrt(1-t/e):0}_setSize(t){this._cubeSize=Math.max(n0,ld(t))}_fromTexture(t,e){t.mapping===Mr||t.mapping===Eo?this._setSize(t.image.length===0?n0:t.image[0].width||t.image[0].image.width):this._setSize(t.image.width/4);let i=e||this._allocateTarget();return this._textureToCubemap(t),this._applyPMREM(i),i}_allocateTarget(){let t=this._cubeSize,e=i0(t,!1,!1),i=Math.log2(t)-$M;for(let s=0;s<=i;s++)e.texture.mipmaps.push({width:t>>s,height:t>>s});return e.texture.name="PMREM",e.texture.isPMREMTexture=!0,e}_getSourceTarget(t=!1){let e=this._cubeSize,i=this._sourceTarget;return(i===null||i.width!==e||t&&i.depthBuffer===!1)&&(i!==null&&i.dispose(),this._sourceTarget=i0(e,!0,t)),this._sourceTarget}_compileMaterial(t){this._boxMesh.material=t,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(t,e,i){let s=this._boxMesh,r=this._cubeCamera;s.material=i,r.renderTarget=t,r.activeMipmapLevel=e;let o=t.width>>e;t.viewport.set(0,0,o,o),r.update(this._renderer,s),t.viewport.set(0,0,t.width,t.height)}_textureToCubemap(t){let e;t.mapping===Mr||t.mapping===Eo?(this._cubemapMaterial===null&&(this._cubemapMaterial=r0()),e=this._cubemapMaterial,e.uniforms.flipEnvMap.value=t.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=s0()),e=this._equirectMaterial),e.uniforms.envMap.value=t,this._renderCube(this._getSourceTarget(),0,e)}_applyPMREM(t){this._ggxMaterial===null&&(this._ggxMaterial=KM(),this._integrationMaterial=JM());let e=this._cubeSize,i=t.texture.mipmaps.length-1,s=this._ggxMaterial.uniforms;s.envMap.value=this._sourceTarget.texture;let r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(e/A0);for(let o=0;o<=i;o++){let a=n.lodToRoughness(o,i);if(o>i-qM)r.roughness.value=a,this._renderCube(t,o,this._integrationMaterial);else{let c=a>0?Math.log2(e)+.5*Math.log2(6/(E0*Math.pow(a,4)))+.5:0;s.roughness.value=a,s.lodBias.value=c,this._renderCube(t,o,this._ggxMaterial)}}}_blur(t,e){this._blurMaterial===null&&(this._blurMaterial=jM());let i=this._blurMaterial,s=i.uniforms,r=this._sourceTarget;s.sigma.value=Math.min(e,Math.PI)/Math.SQRT2,s.envMap.value=r.texture,this._renderCube(t,0,i),s.envMap.value=t.texture,this._renderCube(r,0,i)}};function i0(n,t,e){return new el(n,{minFilter:Is,generateMipmaps:t,type:$i,colorSpace:ba,depthBuffer:e})}function nl(n,t,e){return new Pi({name:n,uniforms:t,vertexShader:fe.cube_vert,fragmentShader:e,side:ii,blending:br,depthTest:!1,depthWrite:!1})}function KM(){return nl("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${E0}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function JM(){return nl("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:A0}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function jM(){return nl("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${XM}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function s0(){return nl("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function r0(){return nl("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function QM(n){let t=new WeakMap,e=new WeakMap,i=null;function s(u,d=!1){return u==null?null:d?o(u):r(u)}function r(u){if(u&&u.isTexture){let d=u.mapping;if(d===Xc||d===qc)if(t.has(u)){let p=t.get(u).texture;return a(p,u.mapping)}else{let p=u.image;if(p&&p.height>0){let _=new el(p.height);return _.fromEquirectangularTexture(n,u),t.set(u,_),u.addEventListener("dispose",l),a(_.texture,u.mapping)}else return null}}return u}function o(u){if(u&&u.isTexture&&u.isPMREMTexture!==!0){let d=u.mapping,p=d===Xc||d===qc,_=d===Mr||d===Eo;if(p||_){let m=e.get(u),g=m!==void 0?m.texture.pmremVersion:0;if(u.isRenderTargetTexture&&u.pmremVersion!==g)return i===null&&(i=new Nh(n)),m=p?i.fromEquirectangular(u,m):i.fromCubemap(u,m),m.texture.pmremVersion=u.pmremVersion,e.set(u,m),m.texture;if(m!==void 0)return m.texture;{let v=u.image;return p&&v&&v.height>0||_&&v&&c(v)?(i===null&&(i=new Nh(n)),m=p?i.fromEquirectangular(u):i.fromCubemap(u),m.texture.pmremVersion=u.pmremVersion,e.set(u,m),u.addEventListener("dispose",h),m.texture):null}}}return u}function a(u,d){return d===Xc?u.mapping=Mr:d===qc&&(u.mapping=Eo),u}function c(u){let d=0,p=6;for(let _=0;_<p;_++)u[_]!==void 0&&d++;return d===p}function l(u){let d=u.target;d.removeEventListener("dispose",l);let p=t.get(d);p!==void 0&&(t.delete(d),p.dispose())}function h(u){let d=u.target;d.removeEventListener("dispose",h);let p=e.get(d);p!==void 0&&(e.delete(d),p.dispose())}function f(){t=new WeakMap,e=new WeakMap,i!==null&&(i.dispose(),i=null)}return{get:s,dispose:f}}function tE(n){let t={};function e(i){if(t[i]!==void 0)return t[i];let s=n.getExtension(i);return t[i]=s,s}return{has:function(i){return e(i)!==null},init:function(){e("EXT_color_buffer_float"),e("WEBGL_clip_cull_distance"),e("OES_texture_float_linear"),e("EXT_color_buffer_half_float"),e("WEBGL_multisampled_render_to_texture"),e("WEBGL_render_shared_exponent")},get:function(i){let s=e(i);return s===null&&ya("WebGLRenderer: "+i+" extension not supported."),s}}}function eE(n,t,e,i){let s={},r=new WeakMap,o=new FinalizationRegistry(p=>delete s[p]);function a(p){c(p.target)}function c(p){p.index!==null&&t.remove(p.index);for(let m in p.attributes)t.remove(p.attributes[m]);p.removeEventListener("dispose",a),delete s[p.id],o.unregister(p);let _=r.get(p);_&&(t.remove(_),r.delete(p)),i.releaseStatesOfGeometry(p),p.isInstancedBufferGeometry===!0&&delete p._maxInstanceCount,e.memory.geometries--}function l(p,_){return s[_.id]!==void 0||(_.addEventListener("dispose",a),s[_.id]=new WeakRef(_),o.register(_,_.id,_),e.memory.geometries++),_}function h(p){let _=p.attributes;for(let m in _)t.update(_[m],n.ARRAY_BUFFER)}function f(p){let _=p.index,m=p.attributes.position,g=0;if(m===void 0)return;let v=_!==null?_.array.length:m.array.length/3-1,T=m.count>=65535?Ra:Ca,S=new T(Math.ceil(v/3)*6,1),C=S.array;if(_!==null){let y=_.array;g=_.version;for(let w=0,V=0;w<v;w+=3){let N=y[w+0],L=y[w+1],B=y[w+2];C[V++]=N,C[V++]=L,C[V++]=L,C[V++]=B,C[V++]=B,C[V++]=N}}else{g=m.version;for(let y=0,w=0;y<v;y+=3){let V=y+0,N=y+1,L=y+2;C[w++]=V,C[w++]=N,C[w++]=N,C[w++]=L,C[w++]=L,C[w++]=V}}S.version=g;let E=r.get(p);E&&t.remove(E),r.set(p,S)}function u(p){let _=r.get(p);if(_){let m=p.index;m!==null&&_.version<m.version&&f(p)}else f(p);return r.get(p)}function d(){for(let p in s){let _=s[p].deref();_!==void 0&&c(_)}}return{get:l,update:h,getWireframeAttribute:u,dispose:d}}function nE(n,t,e){let i;function s(f){i=f}let r,o;function a(f){r=f.type,o=f.bytesPerElement}function c(f,u){n.drawElements(i,u,r,f*o),e.update(u,i,1)}function l(f,u,d){d!==0&&(n.drawElementsInstanced(i,u,r,f*o,d),e.update(u,i,d))}function h(f,u,d){if(d===0)return;t.get("WEBGL_multi_draw").multiDrawElementsWEBGL(i,u,0,r,f,0,d);let _=0;for(let m=0;m<d;m++)_+=u[m];e.update(_,i,1)}this.setMode=s,this.setIndex=a,this.render=c,this.renderInstances=l,this.renderMultiDraw=h}function iE(n){let t={geometries:0,textures:0},e={frame:0,calls:0,triangles:0,points:0,lines:0};function i(r,o,a){switch(e.calls++,o){case n.TRIANGLES:e.triangles+=a*(r/3);break;case n.LINES:e.lines+=a*(r/2);break;case n.LINE_STRIP:e.lines+=a*(r-1);break;case n.LINE_LOOP:e.lines+=a*r;break;case n.POINTS:e.points+=a*r;break;default:re("WebGLInfo: Unknown draw mode:",o);break}}function s(){e.calls=0,e.triangles=0,e.points=0,e.lines=0}return{memory:t,render:e,programs:null,autoReset:!0,reset:s,update:i}}function sE(n,t,e){let i=new WeakMap,s=new Je;function r(o,a,c){let l=o.morphTargetInfluences,h=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,f=h!==void 0?h.length:0,u=i.get(a);if(u===void 0||u.count!==f){let V=function(){y.dispose(),i.delete(a),a.removeEventListener("dispose",V)};u!==void 0&&u.texture.dispose();let d=a.morphAttributes.position!==void 0,p=a.morphAttributes.normal!==void 0,_=a.morphAttributes.color!==void 0,m=a.morphAttributes.position||[],g=a.morphAttributes.normal||[],v=a.morphAttributes.color||[],T=0;d===!0&&(T=1),p===!0&&(T=2),_===!0&&(T=3);let S=a.attributes.position.count*T,C=1;S>t.maxTextureSize&&(C=Math.ceil(S/t.maxTextureSize),S=t.maxTextureSize);let E=new Float32Array(S*C*4*f),y=new Ea(E,S,C,f);y.type=Wi,y.needsUpdate=!0;let w=T*4;for(let N=0;N<f;N++){let L=m[N],B=g[N],F=v[N],R=S*C*4*N;for(let U=0;U<L.count;U++){let X=U*w;d===!0&&(s.fromBufferAttribute(L,U),E[R+X+0]=s.x,E[R+X+1]=s.y,E[R+X+2]=s.z,E[R+X+3]=0),p===!0&&(s.fromBufferAttribute(B,U),E[R+X+4]=s.x,E[R+X+5]=s.y,E[R+X+6]=s.z,E[R+X+7]=0),_===!0&&(s.fromBufferAttribute(F,U),E[R+X+8]=s.x,E[R+X+9]=s.y,E[R+X+10]=s.z,E[R+X+11]=F.itemSize===4?s.w:1)}}u={count:f,texture:y,size:new jt(S,C)},i.set(a,u),a.addEventListener("dispose",V)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)c.getUniforms().setValue(n,"morphTexture",o.morphTexture,e);else{let d=0;for(let _=0;_<l.length;_++)d+=l[_];let p=a.morphTargetsRelative?1:1-d;c.getUniforms().setValue(n,"morphTargetBaseInfluence",p),c.getUniforms().setValue(n,"morphTargetInfluences",l)}c.getUniforms().setValue(n,"morphTargetsTexture",u.texture,e),c.getUniforms().setValue(n,"morphTargetsTextureSize",u.size)}return{update:r}}function rE(n,t,e,i,s){let r=new WeakMap;function o(l){let h=s.render.frame,f=l.geometry,u=t.get(l,f);if(r.get(u)!==h&&(t.update(u),r.set(u,h)),l.isInstancedMesh&&(l.hasEventListener("dispose",c)===!1&&l.addEventListener("dispose",c),r.get(l)!==h&&(e.update(l.instanceMatrix,n.ARRAY_BUFFER),l.instanceColor!==null&&e.update(l.instanceColor,n.ARRAY_BUFFER),r.set(l,h))),l.isSkinnedMesh){let d=l.skeleton;r.get(d)!==h&&(d.update(),r.set(d,h))}return u}function a(){r=new WeakMap}function c(l){let h=l.target;h.removeEventListener("dispose",c),i.releaseStatesOfObject(h),e.remove(h.instanceMatrix),h.instanceColor!==null&&e.remove(h.instanceColor)}return{update:o,dispose:a}}var oE={[Hf]:"LINEAR_TONE_MAPPING",[Vf]:"REINHARD_TONE_MAPPING",[Gf]:"CINEON_TONE_MAPPING",[Wf]:"ACES_FILMIC_TONE_MAPPING",[Xf]:"AGX_TONE_MAPPING",[qf]:"NEUTRAL_TONE_MAPPING",[$f]:"CUSTOM_TONE_MAPPING"};function aE(n,t,e,i,s,r){let o=new vi(t,e,{type:n,depthBuffer:s,stencilBuffer:r,samples:i?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),a=null,c=null,l=null,h=new Hn;h.setAttribute("position",new tn([-1,3,0,-1,-1,0,3,-1,0],3)),h.setAttribute("uv",new tn([0,2,0,0,2,0],2));let f=new Ic({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),u=new ni(h,f),d=new Va(-1,1,1,-1,0,1),p=null,_=null,m=!1,g,v=null,T=[],S=!1;this.setSize=function(C,E){o.setSize(C,E),a!==null&&a.setSize(C,E),c!==null&&c.setSize(C,E);for(let y=0;y<T.length;y++){let w=T[y];w.setSize&&w.setSize(C,E)}},this.setEffects=function(C){T=C,S=T.length>0&&T[0].isRenderPass===!0;let E=o.width,y=o.height;T.length>0&&a===null&&(a=new vi(E,y,{type:$i,depthBuffer:!1,stencilBuffer:!1}),c=new vi(E,y,{type:$i,depthBuffer:!1,stencilBuffer:!1}));let w=s===!0&&T.some(V=>V.needsDepthTexture===!0);w!==(o.depthTexture!==null)&&(w===!0&&l===null&&(l=new Rs(E,y),r===!0&&(l.format=Ps,l.type=Er)),o.dispose(),o.depthTexture=w?l:null,o.resolveDepthBuffer=w,o.storeMultisampledDepthBuffer=w);for(let V=0;V<T.length;V++){let N=T[V];N.setSize&&N.setSize(E,y),w&&N.needsDepthTexture===!0&&N.setDepthTexture&&N.setDepthTexture(l)}},this.begin=function(C,E){if(m||C.toneMapping===cs&&T.length===0)return!1;if(v=E,E!==null){let y=E.width,w=E.height;(o.width!==y||o.height!==w)&&this.setSize(y,w)}return S===!1&&C.setRenderTarget(o),g=C.toneMapping,C.toneMapping=cs,!0},this.hasRenderPass=function(){return S},this.end=function(C,E){C.toneMapping=g,m=!0;let y=o,w=a;for(let V=0;V<T.length;V++){let N=T[V];N.enabled!==!1&&(N.render(C,w,y,E),N.needsSwap!==!1&&(y=w,w=w===a?c:a))}if(p!==C.outputColorSpace||_!==C.toneMapping){p=C.outputColorSpace,_=C.toneMapping,f.defines={},ye.getTransfer(p)===Ie&&(f.defines.SRGB_TRANSFER="");let V=oE[_];V&&(f.defines[V]=""),f.needsUpdate=!0}f.uniforms.tDiffuse.value=y.texture,C.setRenderTarget(v),C.render(u,d),v=null,m=!1},this.isCompositing=function(){return m},this.dispose=function(){o.dispose(),a!==null&&a.dispose(),c!==null&&c.dispose(),h.dispose(),f.dispose()}}var T0=new ci,C0=new Rs(1,1),R0=new La(1),I0=new Ea,P0=new Ec,L0=new Pa,o0=[],a0=[],l0=new Float32Array(16),c0=new Float32Array(9),h0=new Float32Array(4);function Ro(n,t,e){let i=n[0];if(i<=0||i>0)return n;let s=t*e,r=o0[s];if(r===void 0&&(r=new Float32Array(s),o0[s]=r),t!==0){i.toArray(r,0);for(let o=1,a=0;o!==t;++o)a+=e,n[o].toArray(r,a)}return r}function Sn(n,t){if(n.length!==t.length)return!1;for(let e=0,i=n.length;e<i;e++)if(n[e]!==t[e])return!1;return!0}function bn(n,t){for(let e=0,i=t.length;e<i;e++)n[e]=t[e]}function Uh(n,t){let e=a0[t];e===void 0&&(e=new Int32Array(t),a0[t]=e);for(let i=0;i!==t;++i)e[i]=n.allocateTextureUnit();return e}function lE(n,t){let e=this.cache;e[0]!==t&&(n.uniform1f(this.addr,t),e[0]=t)}function cE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(n.uniform2f(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Sn(e,t))return;n.uniform2fv(this.addr,t),bn(e,t)}}function hE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(n.uniform3f(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else if(t.r!==void 0)(e[0]!==t.r||e[1]!==t.g||e[2]!==t.b)&&(n.uniform3f(this.addr,t.r,t.g,t.b),e[0]=t.r,e[1]=t.g,e[2]=t.b);else{if(Sn(e,t))return;n.uniform3fv(this.addr,t),bn(e,t)}}function uE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(n.uniform4f(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Sn(e,t))return;n.uniform4fv(this.addr,t),bn(e,t)}}function fE(n,t){let e=this.cache,i=t.elements;if(i===void 0){if(Sn(e,t))return;n.uniformMatrix2fv(this.addr,!1,t),bn(e,t)}else{if(Sn(e,i))return;h0.set(i),n.uniformMatrix2fv(this.addr,!1,h0),bn(e,i)}}function dE(n,t){let e=this.cache,i=t.elements;if(i===void 0){if(Sn(e,t))return;n.uniformMatrix3fv(this.addr,!1,t),bn(e,t)}else{if(Sn(e,i))return;c0.set(i),n.uniformMatrix3fv(this.addr,!1,c0),bn(e,i)}}function pE(n,t){let e=this.cache,i=t.elements;if(i===void 0){if(Sn(e,t))return;n.uniformMatrix4fv(this.addr,!1,t),bn(e,t)}else{if(Sn(e,i))return;l0.set(i),n.uniformMatrix4fv(this.addr,!1,l0),bn(e,i)}}function mE(n,t){let e=this.cache;e[0]!==t&&(n.uniform1i(this.addr,t),e[0]=t)}function gE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(n.uniform2i(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Sn(e,t))return;n.uniform2iv(this.addr,t),bn(e,t)}}function _E(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(n.uniform3i(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Sn(e,t))return;n.uniform3iv(this.addr,t),bn(e,t)}}function yE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(n.uniform4i(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Sn(e,t))return;n.uniform4iv(this.addr,t),bn(e,t)}}function xE(n,t){let e=this.cache;e[0]!==t&&(n.uniform1ui(this.addr,t),e[0]=t)}function vE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(n.uniform2ui(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Sn(e,t))return;n.uniform2uiv(this.addr,t),bn(e,t)}}function SE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(n.uniform3ui(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Sn(e,t))return;n.uniform3uiv(this.addr,t),bn(e,t)}}function bE(n,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(n.uniform4ui(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Sn(e,t))return;n.uniform4uiv(this.addr,t),bn(e,t)}}function Fh(n){return n.version===0&&(n.compareFunction=sd,n.needsUpdate=!0),n}function wE(n,t,e){let i=this.cache,s=e.allocateTextureUnit();i[0]!==s&&(n.uniform1i(this.addr,s),i[0]=s);let r;this.type===n.SAMPLER_2D_SHADOW?r=Fh(C0):r=T0,e.setTexture2D(t||r,s)}function ME(n,t,e){let i=this.cache,s=e.allocateTextureUnit();i[0]!==s&&(n.uniform1i(this.addr,s),i[0]=s),e.setTexture3D(t||P0,s)}function EE(n,t,e){let i=this.cache,s=e.allocateTextureUnit();i[0]!==s&&(n.uniform1i(this.addr,s),i[0]=s);let r;this.type===n.SAMPLER_CUBE_SHADOW?r=Fh(R0):r=L0,e.setTextureCube(t||r,s)}function AE(n,t,e){let i=this.cache,s=e.allocateTextureUnit();i[0]!==s&&(n.uniform1i(this.addr,s),i[0]=s),e.setTexture2DArray(t||I0,s)}function TE(n){switch(n){case 5126:return lE;case 35664:return cE;case 35665:return hE;case 35666:return uE;case 35674:return fE;case 35675:return dE;case 35676:return pE;case 5124:case 35670:return mE;case 35667:case 35671:return gE;case 35668:case 35672:return _E;case 35669:case 35673:return yE;case 5125:return xE;case 36294:return vE;case 36295:return SE;case 36296:return bE;case 35678:case 36198:case 36298:case 36306:case 35682:return wE;case 35679:case 36299:case 36307:return ME;case 35680:case 36300:case 36308:case 36293:return EE;case 36289:case 36303:case 36311:case 36292:return AE}}function CE(n,t){n.uniform1fv(this.addr,t)}function RE(n,t){let e=Ro(t,this.size,2);n.uniform2fv(this.addr,e)}function IE(n,t){let e=Ro(t,this.size,3);n.uniform3fv(this.addr,e)}function PE(n,t){let e=Ro(t,this.size,4);n.uniform4fv(this.addr,e)}function LE(n,t){let e=Ro(t,this.size,4);n.uniformMatrix2fv(this.addr,!1,e)}function DE(n,t){let e=Ro(t,this.size,9);n.uniformMatrix3fv(this.addr,!1,e)}function NE(n,t){let e=Ro(t,this.size,16);n.uniformMatrix4fv(this.addr,!1,e)}function OE(n,t){n.uniform1iv(this.addr,t)}function UE(n,t){n.uniform2iv(this.addr,t)}function FE(n,t){n.uniform3iv(this.addr,t)}function BE(n,t){n.uniform4iv(this.addr,t)}function kE(n,t){n.uniform1uiv(this.addr,t)}function zE(n,t){n.uniform2uiv(this.addr,t)}function HE(n,t){n.uniform3uiv(this.addr,t)}function VE(n,t){n.uniform4uiv(this.addr,t)}function GE(n,t,e){let i=this.cache,s=t.length,r=Uh(e,s);Sn(i,r)||(n.uniform1iv(this.addr,r),bn(i,r));let o;this.type===n.SAMPLER_2D_SHADOW?o=Fh(C0):o=T0;for(let a=0;a!==s;++a)e.setTexture2D(t[a]||o,r[a])}function WE(n,t,e){let i=this.cache,s=t.length,r=Uh(e,s);Sn(i,r)||(n.uniform1iv(this.addr,r),bn(i,r));for(let o=0;o!==s;++o)e.setTexture3D(t[o]||P0,r[o])}function $E(n,t,e){let i=this.cache,s=t.length,r=Uh(e,s);Sn(i,r)||(n.uniform1iv(this.addr,r),bn(i,r));let o;this.type===n.SAMPLER_CUBE_SHADOW?o=Fh(R0):o=L0;for(let a=0;a!==s;++a)e.setTextureCube(t[a]||o,r[a])}function XE(n,t,e){let i=this.cache,s=t.length,r=Uh(e,s);Sn(i,r)||(n.uniform1iv(this.addr,r),bn(i,r));for(let o=0;o!==s;++o)e.setTexture2DArray(t[o]||I0,r[o])}function qE(n){switch(n){case 5126:return CE;case 35664:return RE;case 35665:return IE;case 35666:return PE;case 35674:return LE;case 35675:return DE;case 35676:return NE;case 5124:case 35670:return OE;case 35667:case 35671:return UE;case 35668:case 35672:return FE;case 35669:case 35673:return BE;case 5125:return kE;case 36294:return zE;case 36295:return HE;case 36296:return VE;case 35678:case 36198:case 36298:case 36306:case 35682:return GE;case 35679:case 36299:case 36307:return WE;case 35680:case 36300:case 36308:case 36293:return $E;case 36289:case 36303:case 36311:case 36292:return XE}}var _d=class{constructor(t,e,i){this.id=t,this.addr=i,this.cache=[],this.type=e.type,this.setValue=TE(e.type)}},yd=class{constructor(t,e,i){this.id=t,this.addr=i,this.cache=[],this.type=e.type,this.size=e.size,this.setValue=qE(e.type)}},xd=class{constructor(t){this.id=t,this.seq=[],this.map={}}setValue(t,e,i){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(t,e[a.id],i)}}},md=/(\w+)(\])?(\[|\.)?/g;function u0(n,t){n.seq.push(t),n.map[t.id]=t}function YE(n,t,e){let i=n.name,s=i.length;for(md.lastIndex=0;;){let r=md.exec(i),o=md.lastIndex,a=r[1],c=r[2]==="]",l=r[3];if(c&&(a=a|0),l===void 0||l==="["&&o+2===s){u0(e,l===void 0?new _d(a,n,t):new yd(a,n,t));break}else{let f=e.map[a];f===void 0&&(f=new xd(a),u0(e,f)),e=f}}}var Co=class{constructor(t,e){this.seq=[],this.map={};let i=t.getProgramParameter(e,t.ACTIVE_UNIFORMS);for(let o=0;o<i;++o){let a=t.getActiveUniform(e,o),c=t.getUniformLocation(e,a.name);YE(a,c,this)}let s=[],r=[];for(let o of this.seq)o.type===t.SAMPLER_2D_SHADOW||o.type===t.SAMPLER_CUBE_SHADOW||o.type===t.SAMPLER_2D_ARRAY_SHADOW?s.push(o):r.push(o);s.length>0&&(this.seq=s.concat(r))}setValue(t,e,i,s){let r=this.map[e];r!==void 0&&r.setValue(t,i,s)}setOptional(t,e,i){let s=e[i];s!==void 0&&this.setValue(t,i,s)}static upload(t,e,i,s){for(let r=0,o=e.length;r!==o;++r){let a=e[r],c=i[a.id];c.needsUpdate!==!1&&a.setValue(t,c.value,s)}}static seqWithValue(t,e){let i=[];for(let s=0,r=t.length;s!==r;++s){let o=t[s];o.id in e&&i.push(o)}return i}};function f0(n,t,e){let i=n.createShader(t);return n.shaderSource(i,e),n.compileShader(i),i}var ZE=37297,KE=0;function JE(n,t){let e=n.split(`
`),i=[],s=Math.max(t-6,0),r=Math.min(t+6,e.length);for(let o=s;o<r;o++){let a=o+1;i.push(`${a===t?">":" "} ${a}: ${e[o]}`)}return i.join(`
`)}var d0=new oe;function jE(n){ye._getMatrix(d0,ye.workingColorSpace,n);let t=`mat3( ${d0.elements.map(e=>e.toFixed(4))} )`;switch(ye.getTransfer(n)){case wa:return[t,"LinearTransferOETF"];case Ie:return[t,"sRGBTransferOETF"];default:return Kt("WebGLProgram: Unsupported color space: ",n),[t,"LinearTransferOETF"]}}function p0(n,t,e){let i=n.getShaderParameter(t,n.COMPILE_STATUS),r=(n.getShaderInfoLog(t)||"").trim();if(i&&r==="")return"";let o=/ERROR: 0:(\d+)/.exec(r);if(o){let a=parseInt(o[1]);return e.toUpperCase()+`

`+r+`

`+JE(n.getShaderSource(t),a)}else return r}function QE(n,t){let e=jE(t);return[`vec4 ${n}( vec4 value ) {`,`	return ${e[1]}( vec4( ${e[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}var tA={[Hf]:"Linear",[Vf]:"Reinhard",[Gf]:"Cineon",[Wf]:"ACESFilmic",[Xf]:"AgX",[qf]:"Neutral",[$f]:"Custom"};function eA(n,t){let e=tA[t];return e===void 0?(Kt("WebGLProgram: Unsupported toneMapping:",t),"vec3 "+n+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+n+"( vec3 color ) { return "+e+"ToneMapping( color ); }"}var Dh=new $;function nA(){ye.getLuminanceCoefficients(Dh);let n=Dh.x.toFixed(4),t=Dh.y.toFixed(4),e=Dh.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${n}, ${t}, ${e} );`,"	return dot( weights, rgb );","}"].join(`
`)}function iA(n){return[n.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",n.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(tl).join(`
`)}function sA(n){let t=[];for(let e in n){let i=n[e];i!==!1&&t.push("#define "+e+" "+i)}return t.join(`
`)}function rA(n,t){let e={},i=n.getProgramParameter(t,n.ACTIVE_ATTRIBUTES);for(let s=0;s<i;s++){let r=n.getActiveAttrib(t,s),o=r.name,a=1;r.type===n.FLOAT_MAT2&&(a=2),r.type===n.FLOAT_MAT3&&(a=3),r.type===n.FLOAT_MAT4&&(a=4),e[o]={type:r.type,location:n.getAttribLocation(t,o),locationSize:a}}return e}function tl(n){return n!==""}function m0(n,t){let e=t.numSpotLightShadows+t.numSpotLightMaps-t.numSpotLightShadowsWithMaps;return n.replace(/NUM_SUN_LIGHTS/g,t.numSunLights).replace(/NUM_DIR_LIGHTS/g,t.numDirLights).replace(/NUM_SPOT_LIGHTS/g,t.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,t.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,e).replace(/NUM_RECT_AREA_LIGHTS/g,t.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,t.numPointLights).replace(/NUM_HEMI_LIGHTS/g,t.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,t.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,t.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,t.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,t.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,t.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,t.numLightProbeGrids)}function g0(n,t){return n.replace(/NUM_CLIPPING_PLANES/g,t.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,t.numClippingPlanes-t.numClipIntersection)}var oA=/^[ \t]*#include +<([\w\d./]+)>/gm;function vd(n){return n.replace(oA,aA)}function aA(n,t){let e=fe[t];if(e===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+t+">");return vd(e)}var lA=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function _0(n){return n.replace(lA,cA)}function cA(n,t,e,i){let s="";for(let r=parseInt(t);r<parseInt(e);r++)s+=i.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function y0(n){let t=`precision ${n.precision} float;
	precision ${n.precision} int;
	precision ${n.precision} sampler2D;
	precision ${n.precision} samplerCube;
	precision ${n.precision} sampler3D;
	precision ${n.precision} sampler2DArray;
	precision ${n.precision} sampler2DShadow;
	precision ${n.precision} samplerCubeShadow;
	precision ${n.precision} sampler2DArrayShadow;
	precision ${n.precision} isampler2D;
	precision ${n.precision} isampler3D;
	precision ${n.precision} isamplerCube;
	precision ${n.precision} isampler2DArray;
	precision ${n.precision} usampler2D;
	precision ${n.precision} usampler3D;
	precision ${n.precision} usamplerCube;
	precision ${n.precision} usampler2DArray;
	`;return n.precision==="highp"?t+=`
#define HIGH_PRECISION`:n.precision==="mediump"?t+=`
#define MEDIUM_PRECISION`:n.precision==="lowp"&&(t+=`
#define LOW_PRECISION`),t}var hA={[$a]:"SHADOWMAP_TYPE_PCF",[wo]:"SHADOWMAP_TYPE_VSM"};function uA(n){return hA[n.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}var fA={[Eo]:"ENVMAP_MODE_REFRACTION"};function dA(n){return n.envMap===!1?"ENVMAP_MODE_REFLECTION":fA[n.envMapMode]||"ENVMAP_MODE_REFLECTION"}var pA={[$c]:"ENVMAP_BLENDING_MULTIPLY",[Ng]:"ENVMAP_BLENDING_MIX",[Og]:"ENVMAP_BLENDING_ADD"};function mA(n){return n.envMap===!1?"ENVMAP_BLENDING_NONE":pA[n.combine]||"ENVMAP_BLENDING_NONE"}function gA(n,t,e,i){let s=n.getContext(),r=e.defines,o=e.vertexShader,a=e.fragmentShader,c=uA(e),l=e.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",h=dA(e),f=mA(e),u=iA(e),d=sA(r),p=s.createProgram(),_,m,g=e.glslVersion?"#version "+e.glslVersion+`
`:"";e.isRawShaderMaterial?(_=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,d].filter(tl).join(`
`),_.length>0&&(_+=`
`),m=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,d].filter(tl).join(`
`),m.length>0&&(m+=`
`)):(_=[y0(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,d,e.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",e.batching?"#define USE_BATCHING":"",e.batchingColor?"#define USE_BATCHING_COLOR":"",e.instancing?"#define USE_INSTANCING":"",e.instancingColor?"#define USE_INSTANCING_COLOR":"",e.instancingMorph?"#define USE_INSTANCING_MORPH":"",e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.map?"#define USE_MAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+h:"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.displacementMap?"#define USE_DISPLACEMENTMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.mapUv?"#define MAP_UV "+e.mapUv:"",e.alphaMapUv?"#define ALPHAMAP_UV "+e.alphaMapUv:"",e.lightMapUv?"#define LIGHTMAP_UV "+e.lightMapUv:"",e.aoMapUv?"#define AOMAP_UV "+e.aoMapUv:"",e.emissiveMapUv?"#define EMISSIVEMAP_UV "+e.emissiveMapUv:"",e.bumpMapUv?"#define BUMPMAP_UV "+e.bumpMapUv:"",e.normalMapUv?"#define NORMALMAP_UV "+e.normalMapUv:"",e.displacementMapUv?"#define DISPLACEMENTMAP_UV "+e.displacementMapUv:"",e.metalnessMapUv?"#define METALNESSMAP_UV "+e.metalnessMapUv:"",e.roughnessMapUv?"#define ROUGHNESSMAP_UV "+e.roughnessMapUv:"",e.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+e.anisotropyMapUv:"",e.clearcoatMapUv?"#define CLEARCOATMAP_UV "+e.clearcoatMapUv:"",e.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+e.clearcoatNormalMapUv:"",e.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+e.clearcoatRoughnessMapUv:"",e.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+e.diffuseRoughnessMapUv:"",e.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+e.iridescenceMapUv:"",e.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+e.iridescenceThicknessMapUv:"",e.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+e.sheenColorMapUv:"",e.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+e.sheenRoughnessMapUv:"",e.specularMapUv?"#define SPECULARMAP_UV "+e.specularMapUv:"",e.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+e.specularColorMapUv:"",e.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+e.specularIntensityMapUv:"",e.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+e.transmissionMapUv:"",e.thicknessMapUv?"#define THICKNESSMAP_UV "+e.thicknessMapUv:"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexNormals?"#define HAS_NORMAL":"",e.vertexColors?"#define USE_COLOR":"",e.vertexAlphas?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.flatShading?"#define FLAT_SHADED":"",e.skinning?"#define USE_SKINNING":"",e.morphTargets?"#define USE_MORPHTARGETS":"",e.morphNormals&&e.flatShading===!1?"#define USE_MORPHNORMALS":"",e.morphColors?"#define USE_MORPHCOLORS":"",e.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+e.morphTextureStride:"",e.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+e.morphTargetsCount:"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+c:"",e.sizeAttenuation?"#define USE_SIZEATTENUATION":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(tl).join(`
`),m=[y0(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,d,e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",e.map?"#define USE_MAP":"",e.matcap?"#define USE_MATCAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+l:"",e.envMap?"#define "+h:"",e.envMap?"#define "+f:"",e.envMapPMREM?"#define ENVMAP_MAX_LOD "+e.envMapMaxLod+".0":"",e.envMapPMREM?"#define ENVMAP_SIZE "+e.envMapSize+".0":"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoat?"#define USE_CLEARCOAT":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.dispersion?"#define USE_DISPERSION":"",e.retroreflection?"#define USE_RETROREFLECTION":"",e.iridescence?"#define USE_IRIDESCENCE":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaTest?"#define USE_ALPHATEST":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.sheen?"#define USE_SHEEN":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexColors||e.instancingColor?"#define USE_COLOR":"",e.vertexAlphas||e.batchingColor?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.gradientMap?"#define USE_GRADIENTMAP":"",e.flatShading?"#define FLAT_SHADED":"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+c:"",e.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",e.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",e.toneMapping!==cs?"#define TONE_MAPPING":"",e.toneMapping!==cs?fe.tonemapping_pars_fragment:"",e.toneMapping!==cs?eA("toneMapping",e.toneMapping):"",e.dithering?"#define DITHERING":"",e.opaque?"#define OPAQUE":"",fe.colorspace_pars_fragment,QE("linearToOutputTexel",e.outputColorSpace),nA(),e.useDepthPacking?"#define DEPTH_PACKING "+e.depthPacking:"",`
`].filter(tl).join(`
`)),o=vd(o),o=m0(o,e),o=g0(o,e),a=vd(a),a=m0(a,e),a=g0(a,e),o=_0(o),a=_0(a),e.isRawShaderMaterial!==!0&&(g=`#version 300 es
`,_=[u,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+_,m=["#define varying in",e.glslVersion===rd?"":"layout(location = 0) out highp vec4 pc_fragColor;",e.glslVersion===rd?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+m);let v=g+_+o,T=g+m+a,S=f0(s,s.VERTEX_SHADER,v),C=f0(s,s.FRAGMENT_SHADER,T);s.attachShader(p,S),s.attachShader(p,C),e.index0AttributeName!==void 0?s.bindAttribLocation(p,0,e.index0AttributeName):e.hasPositionAttribute===!0&&s.bindAttribLocation(p,0,"position"),s.linkProgram(p);function E(N){if(n.debug.checkShaderErrors){let L=s.getProgramInfoLog(p)||"",B=s.getShaderInfoLog(S)||"",F=s.getShaderInfoLog(C)||"",R=L.trim(),U=B.trim(),X=F.trim(),G=!0,ct=!0;if(s.getProgramParameter(p,s.LINK_STATUS)===!1)if(G=!1,typeof n.debug.onShaderError=="function")n.debug.onShaderError(s,p,S,C);else{let I=p0(s,S,"vertex"),k=p0(s,C,"fragment");re("WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(p,s.VALIDATE_STATUS)+`

Material Name: `+N.name+`
Material Type: `+N.type+`

Program Info Log: `+R+`
`+I+`
`+k)}else R!==""?Kt("WebGLProgram: Program Info Log:",R):(U===""||X==="")&&(ct=!1);ct&&(N.diagnostics={runnable:G,programLog:R,vertexShader:{log:U,prefix:_},fragmentShader:{log:X,prefix:m}})}s.deleteShader(S),s.deleteShader(C),y=new Co(s,p),w=rA(s,p)}let y;this.getUniforms=function(){return y===void 0&&E(this),y};let w;this.getAttributes=function(){return w===void 0&&E(this),w};let V=e.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return V===!1&&(V=s.getProgramParameter(p,ZE)),V},this.destroy=function(){i.releaseStatesOfProgram(this),s.deleteProgram(p),this.program=void 0},this.type=e.shaderType,this.name=e.shaderName,this.id=KE++,this.cacheKey=t,this.usedTimes=1,this.program=p,this.vertexShader=S,this.fragmentShader=C,this}var _A=0,Sd=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(t,e,i){let s=this._getShaderCacheForMaterial(t);return s.has(e)===!1&&(s.add(e),e.usedTimes++),s.has(i)===!1&&(s.add(i),i.usedTimes++),this}remove(t){let e=this.materialCache.get(t);for(let i of e)i.usedTimes--,i.usedTimes===0&&this.shaderCache.delete(i.code);return this.materialCache.delete(t),this}getVertexShaderStage(t){return this._getShaderStage(t.vertexShader)}getFragmentShaderStage(t){return this._getShaderStage(t.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(t){let e=this.materialCache,i=e.get(t);return i===void 0&&(i=new Set,e.set(t,i)),i}_getShaderStage(t){let e=this.shaderCache,i=e.get(t);return i===void 0&&(i=new bd(t),e.set(t,i)),i}},bd=class{constructor(t){this.id=_A++,this.code=t,this.usedTimes=0}};function yA(n){return n===ar||n===Ja||n===ja}function xA(n,t,e,i,s,r){let o=new Aa,a=new Sd,c=new Set,l=[],h=new Map,f=i.logarithmicDepthBuffer,u={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function d(y){return c.add(y),y===0?"uv":`uv${y}`}function p(y,w,V,N,L,B){let F=N.fog,R=L.geometry,U=y.isMeshStandardMaterial||y.isMeshLambertMaterial||y.isMeshPhongMaterial?N.environment:null,X=y.isMeshStandardMaterial||y.isMeshLambertMaterial&&!y.envMap||y.isMeshPhongMaterial&&!y.envMap,G=t.get(y.envMap||U,X),ct=u[y.type],I=i.precision;y.precision!==null&&(I=i.getMaxPrecision(y.precision),I!==y.precision&&Kt("WebGLProgram.getParameters:",y.precision,"not supported, using",I,"instead."));let k=R.morphAttributes.position||R.morphAttributes.normal||R.morphAttributes.color,Y=k!==void 0?k.length:0,et=0;R.morphAttributes.position!==void 0&&(et=1),R.morphAttributes.normal!==void 0&&(et=2),R.morphAttributes.color!==void 0&&(et=3);let nt,Z,at,ut;if(ct){let Ct=us[ct];nt=Ct.vertexShader,Z=Ct.fragmentShader}else{nt=y.vertexShader,Z=y.fragmentShader;let Ct=a.getVertexShaderStage(y),ce=a.getFragmentShaderStage(y);a.update(y,Ct,ce),at=Ct.id,ut=ce.id}let dt=n.getRenderTarget(),ot=n.state.buffers.depth.getReversed(),Lt=L.isInstancedMesh===!0,Zt=L.isBatchedMesh===!0,Ut=!!y.map,ne=!!y.matcap,ie=!!G,$t=ie&&G.isPMREMTexture===!0,Re=!!y.aoMap,be=!!y.lightMap,Ve=!!y.bumpMap&&y.wireframe===!1,we=!!y.normalMap,cn=!!y.displacementMap,Se=!!y.emissiveMap,yn=!!y.metalnessMap,en=!!y.roughnessMap,hn=y.anisotropy>0,H=y.clearcoat>0,Rt=y.diffuseRoughness>0,Jt=y.dispersion>0,le=y.retroreflectivity>0,Mt=y.iridescence>0,ke=y.sheen>0,Gt=y.transmission>0,Yt=hn&&!!y.anisotropyMap,P=H&&!!y.clearcoatMap,b=H&&!!y.clearcoatNormalMap,K=H&&!!y.clearcoatRoughnessMap,gt=Rt&&!!y.diffuseRoughnessMap,ft=Mt&&!!y.iridescenceMap,vt=Mt&&!!y.iridescenceThicknessMap,St=ke&&!!y.sheenColorMap,st=ke&&!!y.sheenRoughnessMap,lt=!!y.specularMap,yt=!!y.specularColorMap,z=!!y.specularIntensityMap,ht=Gt&&!!y.transmissionMap,rt=Gt&&!!y.thicknessMap,Et=!!y.gradientMap,xt=!!y.alphaMap,wt=y.alphaTest>0,Wt=!!y.alphaHash,te=!!y.extensions,mt=cs;y.toneMapped&&(dt===null||dt.isXRRenderTarget===!0)&&(mt=n.toneMapping);let zt=$t?G.isCompressedCubeTexture?G.image[0].mipmaps:G.mipmaps:null,ee={shaderID:ct,shaderType:y.type,shaderName:y.name,vertexShader:nt,fragmentShader:Z,defines:y.defines,customVertexShaderID:at,customFragmentShaderID:ut,isRawShaderMaterial:y.isRawShaderMaterial===!0,glslVersion:y.glslVersion,precision:I,batching:Zt,batchingColor:Zt&&L._colorsTexture!==null,instancing:Lt,instancingColor:Lt&&L.instanceColor!==null,instancingMorph:Lt&&L.morphTexture!==null,outputColorSpace:dt===null?n.outputColorSpace:dt.isXRRenderTarget===!0?dt.texture.colorSpace:ye.workingColorSpace,alphaToCoverage:!!y.alphaToCoverage,map:Ut,matcap:ne,envMap:ie,envMapMode:ie&&G.mapping,envMapPMREM:$t,envMapMaxLod:$t?zt.length-1:null,envMapSize:$t?zt[0].width:null,aoMap:Re,lightMap:be,bumpMap:Ve,normalMap:we,displacementMap:cn,emissiveMap:Se,normalMapObjectSpace:we&&y.normalMapType===Bg,normalMapTangentSpace:we&&y.normalMapType===Ph,packedNormalMap:we&&y.normalMapType===Ph&&yA(y.normalMap.format),metalnessMap:yn,roughnessMap:en,anisotropy:hn,anisotropyMap:Yt,clearcoat:H,clearcoatMap:P,clearcoatNormalMap:b,clearcoatRoughnessMap:K,diffuseRoughness:Rt,diffuseRoughnessMap:gt,dispersion:Jt,retroreflection:le,iridescence:Mt,iridescenceMap:ft,iridescenceThicknessMap:vt,sheen:ke,sheenColorMap:St,sheenRoughnessMap:st,specularMap:lt,specularColorMap:yt,specularIntensityMap:z,transmission:Gt,transmissionMap:ht,thicknessMap:rt,gradientMap:Et,opaque:y.transparent===!1&&y.blending===Mo&&y.alphaToCoverage===!1,alphaMap:xt,alphaTest:wt,alphaHash:Wt,combine:y.combine,mapUv:Ut&&d(y.map.channel),aoMapUv:Re&&d(y.aoMap.channel),lightMapUv:be&&d(y.lightMap.channel),bumpMapUv:Ve&&d(y.bumpMap.channel),normalMapUv:we&&d(y.normalMap.channel),displacementMapUv:cn&&d(y.displacementMap.channel),emissiveMapUv:Se&&d(y.emissiveMap.channel),metalnessMapUv:yn&&d(y.metalnessMap.channel),roughnessMapUv:en&&d(y.roughnessMap.channel),anisotropyMapUv:Yt&&d(y.anisotropyMap.channel),clearcoatMapUv:P&&d(y.clearcoatMap.channel),clearcoatNormalMapUv:b&&d(y.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:K&&d(y.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:gt&&d(y.diffuseRoughnessMap.channel),iridescenceMapUv:ft&&d(y.iridescenceMap.channel),iridescenceThicknessMapUv:vt&&d(y.iridescenceThicknessMap.channel),sheenColorMapUv:St&&d(y.sheenColorMap.channel),sheenRoughnessMapUv:st&&d(y.sheenRoughnessMap.channel),specularMapUv:lt&&d(y.specularMap.channel),specularColorMapUv:yt&&d(y.specularColorMap.channel),specularIntensityMapUv:z&&d(y.specularIntensityMap.channel),transmissionMapUv:ht&&d(y.transmissionMap.channel),thicknessMapUv:rt&&d(y.thicknessMap.channel),alphaMapUv:xt&&d(y.alphaMap.channel),vertexTangents:!!R.attributes.tangent&&(we||hn),vertexNormals:!!R.attributes.normal,vertexColors:y.vertexColors,vertexAlphas:y.vertexColors===!0&&!!R.attributes.color&&R.attributes.color.itemSize===4,pointsUvs:L.isPoints===!0&&!!R.attributes.uv&&(Ut||xt),fog:!!F,useFog:y.fog===!0,fogExp2:!!F&&F.isFogExp2,flatShading:y.wireframe===!1&&(y.flatShading===!0||R.attributes.normal===void 0&&we===!1&&(y.isMeshLambertMaterial||y.isMeshPhongMaterial||y.isMeshStandardMaterial||y.isMeshPhysicalMaterial)),sizeAttenuation:y.sizeAttenuation===!0,logarithmicDepthBuffer:f,reversedDepthBuffer:ot,skinning:L.isSkinnedMesh===!0,hasPositionAttribute:R.attributes.position!==void 0,morphTargets:R.morphAttributes.position!==void 0,morphNormals:R.morphAttributes.normal!==void 0,morphColors:R.morphAttributes.color!==void 0,morphTargetsCount:Y,morphTextureStride:et,numSunLights:w.sun.length,numDirLights:w.directional.length,numPointLights:w.point.length,numSpotLights:w.spot.length,numSpotLightMaps:w.spotLightMap.length,numRectAreaLights:w.rectArea.length,numHemiLights:w.hemi.length,numSunLightShadows:w.sunShadowMap.length,numDirLightShadows:w.directionalShadowMap.length,numPointLightShadows:w.pointShadowMap.length,numSpotLightShadows:w.spotShadowMap.length,numSpotLightShadowsWithMaps:w.numSpotLightShadowsWithMaps,numLightProbes:w.numLightProbes,numLightProbeGrids:B.filter(Ct=>Ct.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:y.dithering,shadowMapEnabled:n.shadowMap.enabled&&V.length>0,shadowMapType:n.shadowMap.type,toneMapping:mt,decodeVideoTexture:Ut&&y.map.isVideoTexture===!0&&ye.getTransfer(y.map.colorSpace)===Ie,decodeVideoTextureEmissive:Se&&y.emissiveMap.isVideoTexture===!0&&ye.getTransfer(y.emissiveMap.colorSpace)===Ie,premultipliedAlpha:y.premultipliedAlpha,doubleSided:y.side===si,flipSided:y.side===ii,useDepthPacking:y.depthPacking>=0,depthPacking:y.depthPacking||0,index0AttributeName:y.index0AttributeName,extensionClipCullDistance:te&&y.extensions.clipCullDistance===!0&&e.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(te&&y.extensions.multiDraw===!0||Zt)&&e.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:e.has("KHR_parallel_shader_compile"),customProgramCacheKey:y.customProgramCacheKey()};return ee.vertexUv1s=c.has(1),ee.vertexUv2s=c.has(2),ee.vertexUv3s=c.has(3),c.clear(),ee}function _(y){let w=[];if(y.shaderID?w.push(y.shaderID):(w.push(y.customVertexShaderID),w.push(y.customFragmentShaderID)),y.defines!==void 0)for(let V in y.defines)w.push(V),w.push(y.defines[V]);return y.isRawShaderMaterial===!1&&(m(w,y),g(w,y),w.push(n.outputColorSpace)),w.push(y.customProgramCacheKey),w.join()}function m(y,w){y.push(w.precision),y.push(w.outputColorSpace),y.push(w.envMapMode),y.push(w.envMapPMREM),y.push(w.envMapMaxLod),y.push(w.envMapSize),y.push(w.mapUv),y.push(w.alphaMapUv),y.push(w.lightMapUv),y.push(w.aoMapUv),y.push(w.bumpMapUv),y.push(w.normalMapUv),y.push(w.displacementMapUv),y.push(w.emissiveMapUv),y.push(w.metalnessMapUv),y.push(w.roughnessMapUv),y.push(w.anisotropyMapUv),y.push(w.clearcoatMapUv),y.push(w.clearcoatNormalMapUv),y.push(w.clearcoatRoughnessMapUv),y.push(w.diffuseRoughnessMapUv),y.push(w.iridescenceMapUv),y.push(w.iridescenceThicknessMapUv),y.push(w.sheenColorMapUv),y.push(w.sheenRoughnessMapUv),y.push(w.specularMapUv),y.push(w.specularColorMapUv),y.push(w.specularIntensityMapUv),y.push(w.transmissionMapUv),y.push(w.thicknessMapUv),y.push(w.combine),y.push(w.fogExp2),y.push(w.sizeAttenuation),y.push(w.morphTargetsCount),y.push(w.numSunLights),y.push(w.numDirLights),y.push(w.numPointLights),y.push(w.numSpotLights),y.push(w.numSpotLightMaps),y.push(w.numHemiLights),y.push(w.numRectAreaLights),y.push(w.numSunLightShadows),y.push(w.numDirLightShadows),y.push(w.numPointLightShadows),y.push(w.numSpotLightShadows),y.push(w.numSpotLightShadowsWithMaps),y.push(w.numLightProbes),y.push(w.numLightProbeGrids),y.push(w.shadowMapType),y.push(w.toneMapping),y.push(w.numClippingPlanes),y.push(w.numClipIntersection),y.push(w.depthPacking)}function g(y,w){o.disableAll(),w.instancing&&o.enable(0),w.instancingColor&&o.enable(1),w.instancingMorph&&o.enable(2),w.matcap&&o.enable(3),w.envMap&&o.enable(4),w.normalMapObjectSpace&&o.enable(5),w.normalMapTangentSpace&&o.enable(6),w.clearcoat&&o.enable(7),w.iridescence&&o.enable(8),w.alphaTest&&o.enable(9),w.vertexColors&&o.enable(10),w.vertexAlphas&&o.enable(11),w.vertexUv1s&&o.enable(12),w.vertexUv2s&&o.enable(13),w.vertexUv3s&&o.enable(14),w.vertexTangents&&o.enable(15),w.anisotropy&&o.enable(16),w.alphaHash&&o.enable(17),w.batching&&o.enable(18),w.dispersion&&o.enable(19),w.retroreflection&&o.enable(24),w.diffuseRoughness&&o.enable(25),w.batchingColor&&o.enable(20),w.gradientMap&&o.enable(21),w.packedNormalMap&&o.enable(22),w.vertexNormals&&o.enable(23),y.push(o.mask),o.disableAll(),w.fog&&o.enable(0),w.useFog&&o.enable(1),w.flatShading&&o.enable(2),w.logarithmicDepthBuffer&&o.enable(3),w.reversedDepthBuffer&&o.enable(4),w.skinning&&o.enable(5),w.morphTargets&&o.enable(6),w.morphNormals&&o.enable(7),w.morphColors&&o.enable(8),w.premultipliedAlpha&&o.enable(9),w.shadowMapEnabled&&o.enable(10),w.doubleSided&&o.enable(11),w.flipSided&&o.enable(12),w.useDepthPacking&&o.enable(13),w.dithering&&o.enable(14),w.transmission&&o.enable(15),w.sheen&&o.enable(16),w.opaque&&o.enable(17),w.pointsUvs&&o.enable(18),w.decodeVideoTexture&&o.enable(19),w.decodeVideoTextureEmissive&&o.enable(20),w.alphaToCoverage&&o.enable(21),w.numLightProbeGrids>0&&o.enable(22),w.hasPositionAttribute&&o.enable(23),y.push(o.mask)}function v(y){let w=u[y.type],V;if(w){let N=us[w];V=Qg.clone(N.uniforms)}else V=y.uniforms;return V}function T(y,w){let V=h.get(w);return V!==void 0?++V.usedTimes:(V=new gA(n,w,y,s),l.push(V),h.set(w,V)),V}function S(y){if(--y.usedTimes===0){let w=l.indexOf(y);l[w]=l[l.length-1],l.pop(),h.delete(y.cacheKey),y.destroy()}}function C(y){a.remove(y)}function E(){a.dispose()}return{getParameters:p,getProgramCacheKey:_,getUniforms:v,acquireProgram:T,releaseProgram:S,releaseShaderCache:C,programs:l,dispose:E}}function vA(){let n=new WeakMap;function t(o){return n.has(o)}function e(o){let a=n.get(o);return a===void 0&&(a={},n.set(o,a)),a}function i(o){n.delete(o)}function s(o,a,c){n.get(o)[a]=c}function r(){n=new WeakMap}return{has:t,get:e,remove:i,update:s,dispose:r}}function SA(n,t){return n.groupOrder!==t.groupOrder?n.groupOrder-t.groupOrder:n.renderOrder!==t.renderOrder?n.renderOrder-t.renderOrder:n.material.id!==t.material.id?n.material.id-t.material.id:n.materialVariant!==t.materialVariant?n.materialVariant-t.materialVariant:n.z!==t.z?n.z-t.z:n.id-t.id}function x0(n,t){return n.groupOrder!==t.groupOrder?n.groupOrder-t.groupOrder:n.renderOrder!==t.renderOrder?n.renderOrder-t.renderOrder:n.z!==t.z?t.z-n.z:n.id-t.id}function v0(){let n=[],t=0,e=[],i=[],s=[];function r(){t=0,e.length=0,i.length=0,s.length=0}function o(u){let d=0;return u.isInstancedMesh&&(d+=2),u.isSkinnedMesh&&(d+=1),d}function a(u,d,p,_,m,g){let v=n[t];return v===void 0?(v={id:u.id,object:u,geometry:d,material:p,materialVariant:o(u),groupOrder:_,renderOrder:u.renderOrder,z:m,group:g},n[t]=v):(v.id=u.id,v.object=u,v.geometry=d,v.material=p,v.materialVariant=o(u),v.groupOrder=_,v.renderOrder=u.renderOrder,v.z=m,v.group=g),t++,v}function c(u,d,p,_,m,g,v){v.reversedDepth===!0&&(m=-m);let T=a(u,d,p,_,m,g);p.transmission>0?i.push(T):p.transparent===!0?s.push(T):e.push(T)}function l(u,d,p,_,m,g){let v=a(u,d,p,_,m,g);p.transmission>0?i.unshift(v):p.transparent===!0?s.unshift(v):e.unshift(v)}function h(u,d){e.length>1&&e.sort(u||SA),i.length>1&&i.sort(d||x0),s.length>1&&s.sort(d||x0)}function f(){for(let u=t,d=n.length;u<d;u++){let p=n[u];if(p.id===null)break;p.id=null,p.object=null,p.geometry=null,p.material=null,p.group=null}}return{opaque:e,transmissive:i,transparent:s,init:r,push:c,unshift:l,finish:f,sort:h}}function bA(){let n=new WeakMap;function t(i,s){let r=n.get(i),o;return r===void 0?(o=new v0,n.set(i,[o])):s>=r.length?(o=new v0,r.push(o)):o=r[s],o}function e(){n=new WeakMap}return{get:t,dispose:e}}function wA(){let n={};return{get:function(t){if(n[t.id]!==void 0)return n[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={direction:new $,color:new ue};break;case"SpotLight":e={position:new $,direction:new $,color:new ue,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":e={position:new $,color:new ue,distance:0,decay:0};break;case"HemisphereLight":e={direction:new $,skyColor:new ue,groundColor:new ue};break;case"RectAreaLight":e={color:new ue,position:new $,halfWidth:new $,halfHeight:new $};break}return n[t.id]=e,e}}}function MA(){let n={};return{get:function(t){if(n[t.id]!==void 0)return n[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new jt};break;case"SpotLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new jt};break;case"PointLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new jt,shadowCameraNear:1,shadowCameraFar:1e3};break}return n[t.id]=e,e}}}var EA=0;function AA(n,t){return(t.castShadow?2:0)-(n.castShadow?2:0)+(t.map?1:0)-(n.map?1:0)}function TA(n){let t=new wA,e=MA(),i={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let l=0;l<9;l++)i.probe.push(new $);let s=new $,r=new Be,o=new Be;function a(l){let h=0,f=0,u=0;for(let B=0;B<9;B++)i.probe[B].set(0,0,0);let d=0,p=0,_=0,m=0,g=0,v=0,T=0,S=0,C=0,E=0,y=0,w=0,V=0,N=0;l.sort(AA);for(let B=0,F=l.length;B<F;B++){let R=l[B],U=R.color,X=R.intensity,G=R.distance,ct=null;if(R.shadow&&R.shadow.map&&(R.shadow.map.texture.format===ar?ct=R.shadow.map.texture:ct=R.shadow.map.depthTexture||R.shadow.map.texture),R.isAmbientLight)h+=U.r*X,f+=U.g*X,u+=U.b*X;else if(R.isLightProbe){for(let I=0;I<9;I++)i.probe[I].addScaledVector(R.sh.coefficients[I],X);N++}else if(R.isSunLight){let I=t.get(R);if(I.color.copy(R.color).multiplyScalar(R.intensity),R.castShadow){let k=R.shadow,Y=e.get(R);Y.shadowIntensity=k.intensity,Y.shadowBias=k.bias,Y.shadowNormalBias=k.normalBias,Y.shadowRadius=k.radius,Y.shadowMapSize.copy(k.mapSize).multiply(k.getFrameExtents()),i.sunShadow[p]=Y,i.sunShadowMap[p]=ct;let et=k.getViewportCount();for(let nt=0;nt<et;nt++)i.sunShadowMatrix[_+nt]=k.getMatrix(nt),i.sunShadowCascade[_+nt]=k._cascadeData[nt];_+=et,p++}i.sun[d]=I,d++}else if(R.isDirectionalLight){let I=t.get(R);if(I.color.copy(R.color).multiplyScalar(R.intensity),R.castShadow){let k=R.shadow,Y=e.get(R);Y.shadowIntensity=k.intensity,Y.shadowBias=k.bias,Y.shadowNormalBias=k.normalBias,Y.shadowRadius=k.radius,Y.shadowMapSize=k.mapSize,i.directionalShadow[m]=Y,i.directionalShadowMap[m]=ct,i.directionalShadowMatrix[m]=R.shadow.matrix,C++}i.directional[m]=I,m++}else if(R.isSpotLight){let I=t.get(R);I.position.setFromMatrixPosition(R.matrixWorld),I.color.copy(U).multiplyScalar(X),I.distance=G,I.coneCos=Math.cos(R.angle),I.penumbraCos=Math.cos(R.angle*(1-R.penumbra)),I.decay=R.decay,i.spot[v]=I;let k=R.shadow;if(R.map&&(i.spotLightMap[w]=R.map,w++,k.updateMatrices(R),R.castShadow&&V++),i.spotLightMatrix[v]=k.matrix,R.castShadow){let Y=e.get(R);Y.shadowIntensity=k.intensity,Y.shadowBias=k.bias,Y.shadowNormalBias=k.normalBias,Y.shadowRadius=k.radius,Y.shadowMapSize=k.mapSize,i.spotShadow[v]=Y,i.spotShadowMap[v]=ct,y++}v++}else if(R.isRectAreaLight){let I=t.get(R);I.color.copy(U).multiplyScalar(X),I.halfWidth.set(R.width*.5,0,0),I.halfHeight.set(0,R.height*.5,0),i.rectArea[T]=I,T++}else if(R.isPointLight){let I=t.get(R);if(I.color.copy(R.color).multiplyScalar(R.intensity),I.distance=R.distance,I.decay=R.decay,R.castShadow){let k=R.shadow,Y=e.get(R);Y.shadowIntensity=k.intensity,Y.shadowBias=k.bias,Y.shadowNormalBias=k.normalBias,Y.shadowRadius=k.radius,Y.shadowMapSize=k.mapSize,Y.shadowCameraNear=k.camera.near,Y.shadowCameraFar=k.camera.far,i.pointShadow[g]=Y,i.pointShadowMap[g]=ct,i.pointShadowMatrix[g]=R.shadow.matrix,E++}i.point[g]=I,g++}else if(R.isHemisphereLight){let I=t.get(R);I.skyColor.copy(R.color).multiplyScalar(X),I.groundColor.copy(R.groundColor).multiplyScalar(X),i.hemi[S]=I,S++}}T>0&&(n.has("OES_texture_float_linear")===!0?(i.rectAreaLTC1=Dt.LTC_FLOAT_1,i.rectAreaLTC2=Dt.LTC_FLOAT_2):(i.rectAreaLTC1=Dt.LTC_HALF_1,i.rectAreaLTC2=Dt.LTC_HALF_2)),i.ambient[0]=h,i.ambient[1]=f,i.ambient[2]=u;let L=i.hash;(L.sunLength!==d||L.directionalLength!==m||L.pointLength!==g||L.spotLength!==v||L.rectAreaLength!==T||L.hemiLength!==S||L.numSunShadows!==p||L.numDirectionalShadows!==C||L.numPointShadows!==E||L.numSpotShadows!==y||L.numSpotMaps!==w||L.numLightProbes!==N)&&(i.sun.length=d,i.directional.length=m,i.spot.length=v,i.rectArea.length=T,i.point.length=g,i.hemi.length=S,i.sunShadow.length=p,i.sunShadowMap.length=p,i.sunShadowMatrix.length=_,i.sunShadowCascade.length=_,i.directionalShadow.length=C,i.directionalShadowMap.length=C,i.directionalShadowMatrix.length=C,i.pointShadow.length=E,i.pointShadowMap.length=E,i.pointShadowMatrix.length=E,i.spotShadow.length=y,i.spotShadowMap.length=y,i.spotLightMatrix.length=y+w-V,i.spotLightMap.length=w,i.numSpotLightShadowsWithMaps=V,i.numLightProbes=N,L.sunLength=d,L.directionalLength=m,L.pointLength=g,L.spotLength=v,L.rectAreaLength=T,L.hemiLength=S,L.numSunShadows=p,L.numDirectionalShadows=C,L.numPointShadows=E,L.numSpotShadows=y,L.numSpotMaps=w,L.numLightProbes=N,i.version=EA++)}function c(l,h){let f=0,u=0,d=0,p=0,_=0,m=0,g=h.matrixWorldInverse;for(let v=0,T=l.length;v<T;v++){let S=l[v];if(S.isSunLight){let C=i.sun[f];C.direction.setFromMatrixPosition(S.matrixWorld),C.direction.transformDirection(g),f++}else if(S.isDirectionalLight){let C=i.directional[u];C.direction.setFromMatrixPosition(S.matrixWorld),s.setFromMatrixPosition(S.target.matrixWorld),C.direction.sub(s),C.direction.transformDirection(g),u++}else if(S.isSpotLight){let C=i.spot[p];C.position.setFromMatrixPosition(S.matrixWorld),C.position.applyMatrix4(g),C.direction.setFromMatrixPosition(S.matrixWorld),s.setFromMatrixPosition(S.target.matrixWorld),C.direction.sub(s),C.direction.transformDirection(g),p++}else if(S.isRectAreaLight){let C=i.rectArea[_];C.position.setFromMatrixPosition(S.matrixWorld),C.position.applyMatrix4(g),o.identity(),r.copy(S.matrixWorld),r.premultiply(g),o.extractRotation(r),C.halfWidth.set(S.width*.5,0,0),C.halfHeight.set(0,S.height*.5,0),C.halfWidth.applyMatrix4(o),C.halfHeight.applyMatrix4(o),_++}else if(S.isPointLight){let C=i.point[d];C.position.setFromMatrixPosition(S.matrixWorld),C.position.applyMatrix4(g),d++}else if(S.isHemisphereLight){let C=i.hemi[m];C.direction.setFromMatrixPosition(S.matrixWorld),C.direction.transformDirection(g),m++}}}return{setup:a,setupView:c,state:i}}function S0(n){let t=new TA(n),e=[],i=[],s=[];function r(f){h.camera=f,e.length=0,i.length=0,s.length=0}function o(f){f.isLightProbeGrid?s.push(f):e.push(f)}function a(f){i.push(f)}function c(){t.setup(e),s.sort((f,u)=>f.priority-u.priority||f.id-u.id)}function l(f){t.setupView(e,f)}let h={lightsArray:e,shadowsArray:i,lightProbeGridArray:s,camera:null,lights:t,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:h,setupLights:c,setupLightsView:l,pushLight:o,pushShadow:a}}function CA(n){let t=new WeakMap;function e(s,r=0){let o=t.get(s),a;return o===void 0?(a=new S0(n),t.set(s,[a])):r>=o.length?(a=new S0(n),o.push(a)):a=o[r],a}function i(){t=new WeakMap}return{get:e,dispose:i}}var RA=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,IA=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,PA=[new $(1,0,0),new $(-1,0,0),new $(0,1,0),new $(0,-1,0),new $(0,0,1),new $(0,0,-1)],LA=[new $(0,-1,0),new $(0,-1,0),new $(0,0,1),new $(0,0,-1),new $(0,-1,0),new $(0,-1,0)],b0=new Be,Qa=new $,gd=new $;function DA(n,t,e){let i=new Qs,s=new jt,r=new jt,o=new Je,a=new Pc,c=new Lc,l={},h=e.maxTextureSize,f={[or]:ii,[ii]:or,[si]:si},u=new Pi({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new jt},radius:{value:4}},vertexShader:RA,fragmentShader:IA}),d=u.clone();d.defines.HORIZONTAL_PASS=1;let p=new Hn;p.setAttribute("position",new Xn(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let _=new ni(p,u),m=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=$a;let g=this.type;this.render=function(E,y,w){if(m.enabled===!1||m.autoUpdate===!1&&m.needsUpdate===!1||E.length===0)return;this.type===mg&&(Kt("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=$a);let V=n.getRenderTarget(),N=n.getActiveCubeFace(),L=n.getActiveMipmapLevel(),B=n.state;B.setBlending(br),B.buffers.depth.getReversed()===!0?B.buffers.color.setClear(0,0,0,0):B.buffers.color.setClear(1,1,1,1),B.buffers.depth.setTest(!0),B.setScissorTest(!1);let F=g!==this.type;F&&y.traverse(function(R){R.material&&(Array.isArray(R.material)?R.material.forEach(U=>U.needsUpdate=!0):R.material.needsUpdate=!0)});for(let R=0,U=E.length;R<U;R++){let X=E[R],G=X.shadow;if(G===void 0){Kt("WebGLShadowMap:",X,"has no shadow.");continue}if(G.autoUpdate===!1&&G.needsUpdate===!1)continue;s.copy(G.mapSize);let ct=G.getFrameExtents();s.multiply(ct),r.copy(G.mapSize),(s.x>h||s.y>h)&&(s.x>h&&(r.x=Math.floor(h/ct.x),s.x=r.x*ct.x,G.mapSize.x=r.x),s.y>h&&(r.y=Math.floor(h/ct.y),s.y=r.y*ct.y,G.mapSize.y=r.y));let I=n.state.buffers.depth.getReversed();if(G.camera._reversedDepth=I,G.map===null||F===!0){if(G.map!==null&&(G.map.depthTexture!==null&&(G.map.depthTexture.dispose(),G.map.depthTexture=null),G.map.dispose()),this.type===wo){if(X.isPointLight){Kt("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}G.map=new vi(s.x,s.y,{format:ar,type:$i,minFilter:Bn,magFilter:Bn,generateMipmaps:!1}),G.map.texture.name=X.name+".shadowMap",G.map.depthTexture=new Rs(s.x,s.y,Wi),G.map.depthTexture.name=X.name+".shadowMapDepth",G.map.depthTexture.format=Es,G.map.depthTexture.compareFunction=null,G.map.depthTexture.minFilter=Nn,G.map.depthTexture.magFilter=Nn}else X.isPointLight?(G.map=new el(s.x),G.map.depthTexture=new La(s.x,Gi)):(G.map=new vi(s.x,s.y),G.map.depthTexture=new Rs(s.x,s.y,Gi)),G.map.depthTexture.name=X.name+".shadowMap",G.map.depthTexture.format=Es,this.type===$a?(G.map.depthTexture.compareFunction=I?id:nd,G.map.depthTexture.minFilter=Bn,G.map.depthTexture.magFilter=Bn):(G.map.depthTexture.compareFunction=null,G.map.depthTexture.minFilter=Nn,G.map.depthTexture.magFilter=Nn);G.camera.updateProjectionMatrix()}G.map.isWebGLCubeRenderTarget!==!0&&(G.map.width!==s.x||G.map.height!==s.y)&&G.map.setSize(s.x,s.y);let k=G.map.isWebGLCubeRenderTarget?6:G.getViewportCount();X.isPointLight!==!0&&G.updateMatrices(X,w);let Y=(G.camera.layers.mask&4294967294)!==0?G.camera.layers:w.layers;for(let et=0;et<k;et++){let nt=G.getCamera(et);if(X.isPointLight){let Z=G.camera,at=G.matrix,ut=X.distance||Z.far;ut!==Z.far&&(Z.far=ut,Z.updateProjectionMatrix()),Qa.setFromMatrixPosition(X.matrixWorld),Z.position.copy(Qa),gd.copy(Z.position),gd.add(PA[et]),Z.up.copy(LA[et]),Z.lookAt(gd),Z.updateMatrixWorld(),at.makeTranslation(-Qa.x,-Qa.y,-Qa.z),b0.multiplyMatrices(Z.projectionMatrix,Z.matrixWorldInverse),G._frustum.setFromProjectionMatrix(b0,Z.coordinateSystem,Z.reversedDepth)}if(G.map.isWebGLCubeRenderTarget)n.setRenderTarget(G.map,et),n.clear();else{et===0&&(n.setRenderTarget(G.map),n.clear());let Z=G.getViewport(et);o.set(r.x*Z.x,r.y*Z.y,r.x*Z.z,r.y*Z.w),B.viewport(o)}i=G.getFrustum(et),S(y,w,nt,X,Y,this.type)}G.isPointLightShadow!==!0&&this.type===wo&&v(G,w),G.needsUpdate=!1}g=this.type,m.needsUpdate=!1,n.setRenderTarget(V,N,L)};function v(E,y){let w=t.update(_);u.defines.VSM_SAMPLES!==E.blurSamples&&(u.defines.VSM_SAMPLES=E.blurSamples,d.defines.VSM_SAMPLES=E.blurSamples,u.needsUpdate=!0,d.needsUpdate=!0),E.mapPass===null?E.mapPass=new vi(s.x,s.y,{format:ar,type:$i}):(E.mapPass.width!==E.map.width||E.mapPass.height!==E.map.height)&&E.mapPass.setSize(E.map.width,E.map.height),u.uniforms.shadow_pass.value=E.map.depthTexture,u.uniforms.resolution.value.set(E.map.width,E.map.height),u.uniforms.radius.value=E.radius,n.setRenderTarget(E.mapPass),n.clear(),n.renderBufferDirect(y,null,w,u,_,null),d.uniforms.shadow_pass.value=E.mapPass.texture,d.uniforms.resolution.value.set(E.map.width,E.map.height),d.uniforms.radius.value=E.radius,n.setRenderTarget(E.map),n.clear(),n.renderBufferDirect(y,null,w,d,_,null)}function T(E,y,w,V){let N=null,L=w.isPointLight===!0?E.customDistanceMaterial:E.customDepthMaterial;if(L!==void 0)N=L;else if(N=w.isPointLight===!0?c:a,n.localClippingEnabled&&y.clipShadows===!0&&Array.isArray(y.clippingPlanes)&&y.clippingPlanes.length!==0||y.displacementMap&&y.displacementScale!==0||y.alphaMap&&y.alphaTest>0||y.map&&y.alphaTest>0||y.alphaToCoverage===!0){let B=N.uuid,F=y.uuid,R=l[B];R===void 0&&(R={},l[B]=R);let U=R[F];U===void 0&&(U=N.clone(),R[F]=U,y.addEventListener("dispose",C)),N=U}if(N.visible=y.visible,N.wireframe=y.wireframe,V===wo?N.side=y.shadowSide!==null?y.shadowSide:y.side:N.side=y.shadowSide!==null?y.shadowSide:f[y.side],N.alphaMap=y.alphaMap,N.alphaTest=y.alphaToCoverage===!0?.5:y.alphaTest,N.map=y.map,N.clipShadows=y.clipShadows,N.clippingPlanes=y.clippingPlanes,N.clipIntersection=y.clipIntersection,N.displacementMap=y.displacementMap,N.displacementScale=y.displacementScale,N.displacementBias=y.displacementBias,N.wireframeLinewidth=y.wireframeLinewidth,N.linewidth=y.linewidth,w.isPointLight===!0&&N.isMeshDistanceMaterial===!0){let B=n.properties.get(N);B.light=w}return N}function S(E,y,w,V,N,L){if(E.visible===!1)return;if(E.layers.test(N)&&(E.isMesh||E.isLine||E.isPoints)&&(E.castShadow||E.receiveShadow&&L===wo)&&(!E.frustumCulled||E.intersectsFrustum(i))){E.modelViewMatrix.multiplyMatrices(w.matrixWorldInverse,E.matrixWorld);let R=t.update(E),U=E.material;if(Array.isArray(U)){let X=R.groups;for(let G=0,ct=X.length;G<ct;G++){let I=X[G],k=U[I.materialIndex];if(k&&k.visible){let Y=T(E,k,V,L);E.onBeforeShadow(n,E,y,w,R,Y,I),n.renderBufferDirect(w,null,R,Y,E,I),E.onAfterShadow(n,E,y,w,R,Y,I)}}}else if(U.visible){let X=T(E,U,V,L);E.onBeforeShadow(n,E,y,w,R,X,null),n.renderBufferDirect(w,null,R,X,E,null),E.onAfterShadow(n,E,y,w,R,X,null)}}let F=E.children;for(let R=0,U=F.length;R<U;R++)S(F[R],y,w,V,N,L)}function C(E){E.target.removeEventListener("dispose",C);for(let w in l){let V=l[w],N=E.target.uuid;N in V&&(V[N].dispose(),delete V[N])}}}function NA(n,t){function e(){let z=!1,ht=new Je,rt=null,Et=new Je(0,0,0,0);return{setMask:function(xt){rt!==xt&&!z&&(n.colorMask(xt,xt,xt,xt),rt=xt)},setLocked:function(xt){z=xt},setClear:function(xt,wt,Wt,te,mt){mt===!0&&(xt*=te,wt*=te,Wt*=te),ht.set(xt,wt,Wt,te),Et.equals(ht)===!1&&(n.clearColor(xt,wt,Wt,te),Et.copy(ht))},reset:function(){z=!1,rt=null,Et.set(-1,0,0,0)}}}function i(){let z=!1,ht=!1,rt=null,Et=null,xt=null;return{setReversed:function(wt){if(ht!==wt){let Wt=t.get("EXT_clip_control");wt?Wt.clipControlEXT(Wt.LOWER_LEFT_EXT,Wt.ZERO_TO_ONE_EXT):Wt.clipControlEXT(Wt.LOWER_LEFT_EXT,Wt.NEGATIVE_ONE_TO_ONE_EXT),ht=wt;let te=xt;xt=null,this.setClear(te)}},getReversed:function(){return ht},setTest:function(wt){wt?ot(n.DEPTH_TEST):Lt(n.DEPTH_TEST)},setMask:function(wt){rt!==wt&&!z&&(n.depthMask(wt),rt=wt)},setFunc:function(wt){if(ht&&(wt=Zg[wt]),Et!==wt){switch(wt){case dc:n.depthFunc(n.NEVER);break;case pc:n.depthFunc(n.ALWAYS);break;case mc:n.depthFunc(n.LESS);break;case co:n.depthFunc(n.LEQUAL);break;case gc:n.depthFunc(n.EQUAL);break;case _c:n.depthFunc(n.GEQUAL);break;case yc:n.depthFunc(n.GREATER);break;case xc:n.depthFunc(n.NOTEQUAL);break;default:n.depthFunc(n.LEQUAL)}Et=wt}},setLocked:function(wt){z=wt},setClear:function(wt){xt!==wt&&(xt=wt,ht&&(wt=1-wt),n.clearDepth(wt))},reset:function(){z=!1,rt=null,Et=null,xt=null,ht=!1}}}function s(){let z=!1,ht=null,rt=null,Et=null,xt=null,wt=null,Wt=null,te=null,mt=null;return{setTest:function(zt){z||(zt?ot(n.STENCIL_TEST):Lt(n.STENCIL_TEST))},setMask:function(zt){ht!==zt&&!z&&(n.stencilMask(zt),ht=zt)},setFunc:function(zt,ee,Ct){(rt!==zt||Et!==ee||xt!==Ct)&&(n.stencilFunc(zt,ee,Ct),rt=zt,Et=ee,xt=Ct)},setOp:function(zt,ee,Ct){(wt!==zt||Wt!==ee||te!==Ct)&&(n.stencilOp(zt,ee,Ct),wt=zt,Wt=ee,te=Ct)},setLocked:function(zt){z=zt},setClear:function(zt){mt!==zt&&(n.clearStencil(zt),mt=zt)},reset:function(){z=!1,ht=null,rt=null,Et=null,xt=null,wt=null,Wt=null,te=null,mt=null}}}let r=new e,o=new i,a=new s,c={},l=new WeakMap,h={},f={},u={},d=new WeakMap,p=[],_=null,m=!1,g=null,v=null,T=null,S=null,C=null,E=null,y=null,w=new ue(0,0,0),V=0,N=!1,L=null,B=null,F=null,R=null,U=null,X=n.getParameter(n.MAX_COMBINED_TEXTURE_IMAGE_UNITS),G=!1,ct=0,I=n.getParameter(n.VERSION);I.indexOf("WebGL")!==-1?(ct=parseFloat(/^WebGL (\d)/.exec(I)[1]),G=ct>=1):I.indexOf("OpenGL ES")!==-1&&(ct=parseFloat(/^OpenGL ES (\d)/.exec(I)[1]),G=ct>=2);let k=null,Y={},et=n.getParameter(n.SCISSOR_BOX),nt=n.getParameter(n.VIEWPORT),Z=new Je().fromArray(et),at=new Je().fromArray(nt);function ut(z,ht,rt,Et){let xt=new Uint8Array(4),wt=n.createTexture();n.bindTexture(z,wt),n.texParameteri(z,n.TEXTURE_MIN_FILTER,n.NEAREST),n.texParameteri(z,n.TEXTURE_MAG_FILTER,n.NEAREST);for(let Wt=0;Wt<rt;Wt++)z===n.TEXTURE_3D||z===n.TEXTURE_2D_ARRAY?n.texImage3D(ht,0,n.RGBA,1,1,Et,0,n.RGBA,n.UNSIGNED_BYTE,xt):n.texImage2D(ht+Wt,0,n.RGBA,1,1,0,n.RGBA,n.UNSIGNED_BYTE,xt);return wt}let dt={};dt[n.TEXTURE_2D]=ut(n.TEXTURE_2D,n.TEXTURE_2D,1),dt[n.TEXTURE_CUBE_MAP]=ut(n.TEXTURE_CUBE_MAP,n.TEXTURE_CUBE_MAP_POSITIVE_X,6),dt[n.TEXTURE_2D_ARRAY]=ut(n.TEXTURE_2D_ARRAY,n.TEXTURE_2D_ARRAY,1,1),dt[n.TEXTURE_3D]=ut(n.TEXTURE_3D,n.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),ot(n.DEPTH_TEST),o.setFunc(co),Ve(!1),we(Of),ot(n.CULL_FACE),Re(br);function ot(z){h[z]!==!0&&(n.enable(z),h[z]=!0)}function Lt(z){h[z]!==!1&&(n.disable(z),h[z]=!1)}function Zt(z,ht){return u[z]!==ht?(n.bindFramebuffer(z,ht),u[z]=ht,z===n.DRAW_FRAMEBUFFER&&(u[n.FRAMEBUFFER]=ht),z===n.FRAMEBUFFER&&(u[n.DRAW_FRAMEBUFFER]=ht),!0):!1}function Ut(z,ht){let rt=p,Et=!1;if(z){rt=d.get(ht),rt===void 0&&(rt=[],d.set(ht,rt));let xt=z.textures;if(rt.length!==xt.length||rt[0]!==n.COLOR_ATTACHMENT0){for(let wt=0,Wt=xt.length;wt<Wt;wt++)rt[wt]=n.COLOR_ATTACHMENT0+wt;rt.length=xt.length,Et=!0}}else rt[0]!==n.BACK&&(rt[0]=n.BACK,Et=!0);Et&&n.drawBuffers(rt)}function ne(z){return _!==z?(n.useProgram(z),_=z,!0):!1}let ie={[wr]:n.FUNC_ADD,[_g]:n.FUNC_SUBTRACT,[yg]:n.FUNC_REVERSE_SUBTRACT};ie[xg]=n.MIN,ie[vg]=n.MAX;let $t={[Sg]:n.ZERO,[bg]:n.ONE,[wg]:n.SRC_COLOR,[kf]:n.SRC_ALPHA,[Rg]:n.SRC_ALPHA_SATURATE,[Tg]:n.DST_COLOR,[Eg]:n.DST_ALPHA,[Mg]:n.ONE_MINUS_SRC_COLOR,[zf]:n.ONE_MINUS_SRC_ALPHA,[Cg]:n.ONE_MINUS_DST_COLOR,[Ag]:n.ONE_MINUS_DST_ALPHA,[Ig]:n.CONSTANT_COLOR,[Pg]:n.ONE_MINUS_CONSTANT_COLOR,[Lg]:n.CONSTANT_ALPHA,[Dg]:n.ONE_MINUS_CONSTANT_ALPHA};function Re(z,ht,rt,Et,xt,wt,Wt,te,mt,zt){if(z===br){m===!0&&(Lt(n.BLEND),m=!1);return}if(m===!1&&(ot(n.BLEND),m=!0),z!==gg){if(z!==g||zt!==N){if((v!==wr||C!==wr)&&(n.blendEquation(n.FUNC_ADD),v=wr,C=wr),zt)switch(z){case Mo:n.blendFuncSeparate(n.ONE,n.ONE_MINUS_SRC_ALPHA,n.ONE,n.ONE_MINUS_SRC_ALPHA);break;case Uf:n.blendFunc(n.ONE,n.ONE);break;case Ff:n.blendFuncSeparate(n.ZERO,n.ONE_MINUS_SRC_COLOR,n.ZERO,n.ONE);break;case Bf:n.blendFuncSeparate(n.DST_COLOR,n.ONE_MINUS_SRC_ALPHA,n.ZERO,n.ONE);break;default:re("WebGLState: Invalid blending: ",z);break}else switch(z){case Mo:n.blendFuncSeparate(n.SRC_ALPHA,n.ONE_MINUS_SRC_ALPHA,n.ONE,n.ONE_MINUS_SRC_ALPHA);break;case Uf:n.blendFuncSeparate(n.SRC_ALPHA,n.ONE,n.ONE,n.ONE);break;case Ff:re("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case Bf:re("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:re("WebGLState: Invalid blending: ",z);break}T=null,S=null,E=null,y=null,w.set(0,0,0),V=0,g=z,N=zt}return}xt=xt||ht,wt=wt||rt,Wt=Wt||Et,(ht!==v||xt!==C)&&(n.blendEquationSeparate(ie[ht],ie[xt]),v=ht,C=xt),(rt!==T||Et!==S||wt!==E||Wt!==y)&&(n.blendFuncSeparate($t[rt],$t[Et],$t[wt],$t[Wt]),T=rt,S=Et,E=wt,y=Wt),(te.equals(w)===!1||mt!==V)&&(n.blendColor(te.r,te.g,te.b,mt),w.copy(te),V=mt),g=z,N=!1}function be(z,ht){z.side===si?Lt(n.CULL_FACE):ot(n.CULL_FACE);let rt=z.side===ii;ht&&(rt=!rt),Ve(rt),z.blending===Mo&&z.transparent===!1?Re(br):Re(z.blending,z.blendEquation,z.blendSrc,z.blendDst,z.blendEquationAlpha,z.blendSrcAlpha,z.blendDstAlpha,z.blendColor,z.blendAlpha,z.premultipliedAlpha),o.setFunc(z.depthFunc),o.setTest(z.depthTest),o.setMask(z.depthWrite),r.setMask(z.colorWrite);let Et=z.stencilWrite;a.setTest(Et),Et&&(a.setMask(z.stencilWriteMask),a.setFunc(z.stencilFunc,z.stencilRef,z.stencilFuncMask),a.setOp(z.stencilFail,z.stencilZFail,z.stencilZPass)),Se(z.polygonOffset,z.polygonOffsetFactor,z.polygonOffsetUnits),z.alphaToCoverage===!0?ot(n.SAMPLE_ALPHA_TO_COVERAGE):Lt(n.SAMPLE_ALPHA_TO_COVERAGE)}function Ve(z){L!==z&&(z?n.frontFace(n.CW):n.frontFace(n.CCW),L=z)}function we(z){z!==dg?(ot(n.CULL_FACE),z!==B&&(z===Of?n.cullFace(n.BACK):z===pg?n.cullFace(n.FRONT):n.cullFace(n.FRONT_AND_BACK))):Lt(n.CULL_FACE),B=z}function cn(z){z!==F&&(G&&n.lineWidth(z),F=z)}function Se(z,ht,rt){z?(ot(n.POLYGON_OFFSET_FILL),(R!==ht||U!==rt)&&(R=ht,U=rt,o.getReversed()&&(ht=-ht,rt=-rt),n.polygonOffset(ht,rt))):Lt(n.POLYGON_OFFSET_FILL)}function yn(z){z?ot(n.SCISSOR_TEST):Lt(n.SCISSOR_TEST)}function en(z){z===void 0&&(z=n.TEXTURE0+X-1),k!==z&&(n.activeTexture(z),k=z)}function hn(z,ht,rt){rt===void 0&&(k===null?rt=n.TEXTURE0+X-1:rt=k);let Et=Y[rt];Et===void 0&&(Et={type:void 0,texture:void 0},Y[rt]=Et),(Et.type!==z||Et.texture!==ht)&&(k!==rt&&(n.activeTexture(rt),k=rt),n.bindTexture(z,ht||dt[z]),Et.type=z,Et.texture=ht)}function H(){let z=Y[k];z!==void 0&&z.type!==void 0&&(n.bindTexture(z.type,null),z.type=void 0,z.texture=void 0)}function Rt(){try{n.compressedTexImage2D(...arguments)}catch(z){re("WebGLState:",z)}}function Jt(){try{n.compressedTexImage3D(...arguments)}catch(z){re("WebGLState:",z)}}function le(){try{n.texSubImage2D(...arguments)}catch(z){re("WebGLState:",z)}}function Mt(){try{n.texSubImage3D(...arguments)}catch(z){re("WebGLState:",z)}}function ke(){try{n.compressedTexSubImage2D(...arguments)}catch(z){re("WebGLState:",z)}}function Gt(){try{n.compressedTexSubImage3D(...arguments)}catch(z){re("WebGLState:",z)}}function Yt(){try{n.texStorage2D(...arguments)}catch(z){re("WebGLState:",z)}}function P(){try{n.texStorage3D(...arguments)}catch(z){re("WebGLState:",z)}}function b(){try{n.texImage2D(...arguments)}catch(z){re("WebGLState:",z)}}function K(){try{n.texImage3D(...arguments)}catch(z){re("WebGLState:",z)}}function gt(z){return f[z]!==void 0?f[z]:n.getParameter(z)}function ft(z,ht){f[z]!==ht&&(n.pixelStorei(z,ht),f[z]=ht)}function vt(z){Z.equals(z)===!1&&(n.scissor(z.x,z.y,z.z,z.w),Z.copy(z))}function St(z){at.equals(z)===!1&&(n.viewport(z.x,z.y,z.z,z.w),at.copy(z))}function st(z,ht){let rt=l.get(ht);rt===void 0&&(rt=new WeakMap,l.set(ht,rt));let Et=rt.get(z);Et===void 0&&(Et=n.getUniformBlockIndex(ht,z.name),n.uniformBlockBinding(ht,Et,Et),rt.set(z,Et))}function lt(z,ht,rt){let xt=l.get(ht).get(z);c[xt]!==rt&&(n.bindBufferBase(n.UNIFORM_BUFFER,xt,rt),c[xt]=rt)}function yt(){n.disable(n.BLEND),n.disable(n.CULL_FACE),n.disable(n.DEPTH_TEST),n.disable(n.POLYGON_OFFSET_FILL),n.disable(n.SCISSOR_TEST),n.disable(n.STENCIL_TEST),n.disable(n.SAMPLE_ALPHA_TO_COVERAGE),n.blendEquation(n.FUNC_ADD),n.blendFunc(n.ONE,n.ZERO),n.blendFuncSeparate(n.ONE,n.ZERO,n.ONE,n.ZERO),n.blendColor(0,0,0,0),n.colorMask(!0,!0,!0,!0),n.clearColor(0,0,0,0),n.depthMask(!0),n.depthFunc(n.LESS),o.setReversed(!1),n.clearDepth(1),n.stencilMask(4294967295),n.stencilFunc(n.ALWAYS,0,4294967295),n.stencilOp(n.KEEP,n.KEEP,n.KEEP),n.clearStencil(0),n.cullFace(n.BACK),n.frontFace(n.CCW),n.polygonOffset(0,0),n.activeTexture(n.TEXTURE0),n.bindFramebuffer(n.FRAMEBUFFER,null),n.bindFramebuffer(n.DRAW_FRAMEBUFFER,null),n.bindFramebuffer(n.READ_FRAMEBUFFER,null),n.useProgram(null),n.lineWidth(1),n.scissor(0,0,n.canvas.width,n.canvas.height),n.viewport(0,0,n.canvas.width,n.canvas.height),n.pixelStorei(n.PACK_ALIGNMENT,4),n.pixelStorei(n.UNPACK_ALIGNMENT,4),n.pixelStorei(n.UNPACK_FLIP_Y_WEBGL,!1),n.pixelStorei(n.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),n.pixelStorei(n.UNPACK_COLORSPACE_CONVERSION_WEBGL,n.BROWSER_DEFAULT_WEBGL),n.pixelStorei(n.PACK_ROW_LENGTH,0),n.pixelStorei(n.PACK_SKIP_PIXELS,0),n.pixelStorei(n.PACK_SKIP_ROWS,0),n.pixelStorei(n.UNPACK_ROW_LENGTH,0),n.pixelStorei(n.UNPACK_IMAGE_HEIGHT,0),n.pixelStorei(n.UNPACK_SKIP_PIXELS,0),n.pixelStorei(n.UNPACK_SKIP_ROWS,0),n.pixelStorei(n.UNPACK_SKIP_IMAGES,0),h={},f={},k=null,Y={},u={},c={},d=new WeakMap,p=[],_=null,m=!1,g=null,v=null,T=null,S=null,C=null,E=null,y=null,w=new ue(0,0,0),V=0,N=!1,L=null,B=null,F=null,R=null,U=null,Z.set(0,0,n.canvas.width,n.canvas.height),at.set(0,0,n.canvas.width,n.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:ot,disable:Lt,bindFramebuffer:Zt,drawBuffers:Ut,useProgram:ne,setBlending:Re,setMaterial:be,setFlipSided:Ve,setCullFace:we,setLineWidth:cn,setPolygonOffset:Se,setScissorTest:yn,activeTexture:en,bindTexture:hn,unbindTexture:H,compressedTexImage2D:Rt,compressedTexImage3D:Jt,texImage2D:b,texImage3D:K,pixelStorei:ft,getParameter:gt,updateUBOMapping:st,uniformBlockBinding:lt,texStorage2D:Yt,texStorage3D:P,texSubImage2D:le,texSubImage3D:Mt,compressedTexSubImage2D:ke,compressedTexSubImage3D:Gt,scissor:vt,viewport:St,reset:yt}}function OA(n,t,e,i,s,r,o){let a=t.has("WEBGL_multisampled_render_to_texture")?t.get("WEBGL_multisampled_render_to_texture"):null,c=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),l=new jt,h=new WeakMap,f=new Set,u,d=new WeakMap,p=new Set,_=new FinalizationRegistry(P=>p.delete(P)),m=!1;try{m=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function g(P,b){return m?new OffscreenCanvas(P,b):Ma("canvas")}function v(P,b,K){let gt=1,ft=Yt(P);if((ft.width>K||ft.height>K)&&(gt=K/Math.max(ft.width,ft.height)),gt<1)if(typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&P instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&P instanceof ImageBitmap||typeof VideoFrame<"u"&&P instanceof VideoFrame){let vt=Math.floor(gt*ft.width),St=Math.floor(gt*ft.height);u===void 0&&(u=g(vt,St));let st=b?g(vt,St):u;return st.width=vt,st.height=St,st.getContext("2d").drawImage(P,0,0,vt,St),Kt("WebGLRenderer: Texture has been resized from ("+ft.width+"x"+ft.height+") to ("+vt+"x"+St+")."),st}else return"data"in P&&Kt("WebGLRenderer: Image in DataTexture is too big ("+ft.width+"x"+ft.height+")."),P;return P}function T(P){return P.generateMipmaps}function S(P){n.generateMipmap(P)}function C(P){return P.isWebGLCubeRenderTarget?n.TEXTURE_CUBE_MAP:P.isWebGL3DRenderTarget?n.TEXTURE_3D:P.isWebGLArrayRenderTarget||P.isCompressedArrayTexture?n.TEXTURE_2D_ARRAY:n.TEXTURE_2D}function E(P,b,K,gt,ft,vt=!1){if(P!==null){if(n[P]!==void 0)return n[P];Kt("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+P+"'")}let St;gt&&(St=t.get("EXT_texture_norm16"),St||Kt("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let st=b;if(b===n.RED&&(K===n.FLOAT&&(st=n.R32F),K===n.HALF_FLOAT&&(st=n.R16F),K===n.UNSIGNED_BYTE&&(st=n.R8),K===n.UNSIGNED_SHORT&&St&&(st=St.R16_EXT),K===n.SHORT&&St&&(st=St.R16_SNORM_EXT)),b===n.RED_INTEGER&&(K===n.UNSIGNED_BYTE&&(st=n.R8UI),K===n.UNSIGNED_SHORT&&(st=n.R16UI),K===n.UNSIGNED_INT&&(st=n.R32UI),K===n.BYTE&&(st=n.R8I),K===n.SHORT&&(st=n.R16I),K===n.INT&&(st=n.R32I)),b===n.RG&&(K===n.FLOAT&&(st=n.RG32F),K===n.HALF_FLOAT&&(st=n.RG16F),K===n.UNSIGNED_BYTE&&(st=n.RG8),K===n.UNSIGNED_SHORT&&St&&(st=St.RG16_EXT),K===n.SHORT&&St&&(st=St.RG16_SNORM_EXT)),b===n.RG_INTEGER&&(K===n.UNSIGNED_BYTE&&(st=n.RG8UI),K===n.UNSIGNED_SHORT&&(st=n.RG16UI),K===n.UNSIGNED_INT&&(st=n.RG32UI),K===n.BYTE&&(st=n.RG8I),K===n.SHORT&&(st=n.RG16I),K===n.INT&&(st=n.RG32I)),b===n.RGB_INTEGER&&(K===n.UNSIGNED_BYTE&&(st=n.RGB8UI),K===n.UNSIGNED_SHORT&&(st=n.RGB16UI),K===n.UNSIGNED_INT&&(st=n.RGB32UI),K===n.BYTE&&(st=n.RGB8I),K===n.SHORT&&(st=n.RGB16I),K===n.INT&&(st=n.RGB32I)),b===n.RGBA_INTEGER&&(K===n.UNSIGNED_BYTE&&(st=n.RGBA8UI),K===n.UNSIGNED_SHORT&&(st=n.RGBA16UI),K===n.UNSIGNED_INT&&(st=n.RGBA32UI),K===n.BYTE&&(st=n.RGBA8I),K===n.SHORT&&(st=n.RGBA16I),K===n.INT&&(st=n.RGBA32I)),b===n.RGB&&(K===n.UNSIGNED_SHORT&&St&&(st=St.RGB16_EXT),K===n.SHORT&&St&&(st=St.RGB16_SNORM_EXT),K===n.UNSIGNED_INT_5_9_9_9_REV&&(st=n.RGB9_E5),K===n.UNSIGNED_INT_10F_11F_11F_REV&&(st=n.R11F_G11F_B10F)),b===n.RGBA){let lt=vt?wa:ye.getTransfer(ft);K===n.FLOAT&&(st=n.RGBA32F),K===n.HALF_FLOAT&&(st=n.RGBA16F),K===n.UNSIGNED_BYTE&&(st=lt===Ie?n.SRGB8_ALPHA8:n.RGBA8),K===n.UNSIGNED_SHORT&&St&&(st=St.RGBA16_EXT),K===n.SHORT&&St&&(st=St.RGBA16_SNORM_EXT),K===n.UNSIGNED_SHORT_4_4_4_4&&(st=n.RGBA4),K===n.UNSIGNED_SHORT_5_5_5_1&&(st=n.RGB5_A1)}return(st===n.R16F||st===n.R32F||st===n.RG16F||st===n.RG32F||st===n.RGBA16F||st===n.RGBA32F)&&t.get("EXT_color_buffer_float"),st}function y(P,b){let K;return P?b===null||b===Gi||b===Er?K=n.DEPTH24_STENCIL8:b===Wi?K=n.DEPTH32F_STENCIL8:b===Ao&&(K=n.DEPTH24_STENCIL8,Kt("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):b===null||b===Gi||b===Er?K=n.DEPTH_COMPONENT24:b===Wi?K=n.DEPTH_COMPONENT32F:b===Ao&&(K=n.DEPTH_COMPONENT16),K}function w(P,b){return T(P)===!0||P.isFramebufferTexture&&P.minFilter!==Nn&&P.minFilter!==Bn?Math.log2(Math.max(b.width,b.height))+1:P.mipmaps.length>0?P.mipmaps.length:P.isCompressedTexture&&Array.isArray(P.image)?b.mipmaps.length:1}function V(P){let b=new WeakRef(P);i.get(P).__ref=b,p.add(b),_.register(P,b,b)}function N(P){let b=i.get(P).__ref;b!==void 0&&(p.delete(b),_.unregister(b))}function L(P){F(P.target)}function B(P){R(P.target)}function F(P){P.removeEventListener("dispose",L),N(P),X(P),P.isVideoTexture&&h.delete(P),P.isHTMLTexture&&f.delete(P)}function R(P){P.removeEventListener("dispose",B),N(P),ct(P)}function U(){for(let P of p){let b=P.deref();b!==void 0&&(b.isRenderTarget===!0?R(b):F(b))}p.clear(),f.clear()}function X(P){let b=i.get(P);if(b.__webglInit===void 0)return;let K=P.source,gt=d.get(K);if(gt){let ft=gt[b.__cacheKey];ft.usedTimes--,ft.usedTimes===0&&G(P),Object.keys(gt).length===0&&d.delete(K)}i.remove(P)}function G(P){let b=i.get(P);n.deleteTexture(b.__webglTexture);let K=P.source,gt=d.get(K);delete gt[b.__cacheKey],o.memory.textures--}function ct(P){let b=i.get(P);b.__depthDisposeCallback&&b.__depthDisposeCallback();let K=P.depthTexture;if(K&&K.renderTarget===P&&F(K),P.isWebGLCubeRenderTarget)for(let ft=0;ft<6;ft++){if(Array.isArray(b.__webglFramebuffer[ft]))for(let vt=0;vt<b.__webglFramebuffer[ft].length;vt++)n.deleteFramebuffer(b.__webglFramebuffer[ft][vt]);else n.deleteFramebuffer(b.__webglFramebuffer[ft]);b.__webglDepthbuffer&&n.deleteRenderbuffer(b.__webglDepthbuffer[ft])}else{if(Array.isArray(b.__webglFramebuffer))for(let ft=0;ft<b.__webglFramebuffer.length;ft++)n.deleteFramebuffer(b.__webglFramebuffer[ft]);else n.deleteFramebuffer(b.__webglFramebuffer);if(b.__webglDepthbuffer&&n.deleteRenderbuffer(b.__webglDepthbuffer),b.__webglMultisampledFramebuffer&&n.deleteFramebuffer(b.__webglMultisampledFramebuffer),b.__webglColorRenderbuffer)for(let ft=0;ft<b.__webglColorRenderbuffer.length;ft++)b.__webglColorRenderbuffer[ft]&&n.deleteRenderbuffer(b.__webglColorRenderbuffer[ft]);b.__webglDepthRenderbuffer&&n.deleteRenderbuffer(b.__webglDepthRenderbuffer)}let gt=P.textures;for(let ft=0,vt=gt.length;ft<vt;ft++){let St=i.get(gt[ft]);St.__webglTexture&&(n.deleteTexture(St.__webglTexture),o.memory.textures--),i.remove(gt[ft])}i.remove(P)}let I=0;function k(){I=0}function Y(){return I}function et(P){I=P}function nt(){let P=I;return P>=s.maxTextures&&Kt("WebGLTextures: Trying to use "+(P+1)+" texture units while this GPU supports only "+s.maxTextures),I+=1,P}function Z(P){let b=[];return b.push(P.wrapS),b.push(P.wrapT),b.push(P.wrapR||0),b.push(P.magFilter),b.push(P.minFilter),b.push(P.anisotropy),b.push(P.internalFormat),b.push(P.format),b.push(P.type),b.push(P.generateMipmaps),b.push(P.mipmapsAutoUpdate),b.push(P.premultiplyAlpha),b.push(P.flipY),b.push(P.unpackAlignment),b.push(P.colorSpace),b.join()}function at(P,b){let K=i.get(P);if(P.isVideoTexture&&ke(P),P.isRenderTargetTexture===!1&&P.isExternalTexture!==!0&&P.version>0&&K.__version!==P.version){let gt=P.image;if(gt===null)Kt("WebGLRenderer: Texture marked for update but no image data found.");else if(gt.complete===!1)Kt("WebGLRenderer: Texture marked for update but image is incomplete");else{be(K,P,b);return}}else P.isExternalTexture&&(K.__webglTexture=P.sourceTexture?P.sourceTexture:null);e.bindTexture(n.TEXTURE_2D,K.__webglTexture,n.TEXTURE0+b)}function ut(P,b){let K=i.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&K.__version!==P.version){be(K,P,b);return}else P.isExternalTexture&&(K.__webglTexture=P.sourceTexture?P.sourceTexture:null);e.bindTexture(n.TEXTURE_2D_ARRAY,K.__webglTexture,n.TEXTURE0+b)}function dt(P,b){let K=i.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&K.__version!==P.version){be(K,P,b);return}e.bindTexture(n.TEXTURE_3D,K.__webglTexture,n.TEXTURE0+b)}function ot(P,b){let K=i.get(P);if(P.version>0&&K.__version!==P.version){Ve(K,P,b);return}e.bindTexture(n.TEXTURE_CUBE_MAP,K.__webglTexture,n.TEXTURE0+b)}let Lt={[vc]:n.REPEAT,[as]:n.CLAMP_TO_EDGE,[Sc]:n.MIRRORED_REPEAT},Zt={[Nn]:n.NEAREST,[Ug]:n.NEAREST_MIPMAP_NEAREST,[Xa]:n.NEAREST_MIPMAP_LINEAR,[Bn]:n.LINEAR,[Yc]:n.LINEAR_MIPMAP_NEAREST,[Is]:n.LINEAR_MIPMAP_LINEAR},Ut={[zg]:n.NEVER,[sd]:n.ALWAYS,[Hg]:n.LESS,[nd]:n.LEQUAL,[Vg]:n.EQUAL,[id]:n.GEQUAL,[Gg]:n.GREATER,[Wg]:n.NOTEQUAL};function ne(P,b){if(b.type===Wi&&t.has("OES_texture_float_linear")===!1&&(b.magFilter===Bn||b.magFilter===Yc||b.magFilter===Xa||b.magFilter===Is||b.minFilter===Bn||b.minFilter===Yc||b.minFilter===Xa||b.minFilter===Is)&&Kt("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),n.texParameteri(P,n.TEXTURE_WRAP_S,Lt[b.wrapS]),n.texParameteri(P,n.TEXTURE_WRAP_T,Lt[b.wrapT]),(P===n.TEXTURE_3D||P===n.TEXTURE_2D_ARRAY)&&n.texParameteri(P,n.TEXTURE_WRAP_R,Lt[b.wrapR]),n.texParameteri(P,n.TEXTURE_MAG_FILTER,Zt[b.magFilter]),n.texParameteri(P,n.TEXTURE_MIN_FILTER,Zt[b.minFilter]),b.compareFunction&&(n.texParameteri(P,n.TEXTURE_COMPARE_MODE,n.COMPARE_REF_TO_TEXTURE),n.texParameteri(P,n.TEXTURE_COMPARE_FUNC,Ut[b.compareFunction])),t.has("EXT_texture_filter_anisotropic")===!0){if(b.magFilter===Nn||b.minFilter!==Xa&&b.minFilter!==Is||b.type===Wi&&t.has("OES_texture_float_linear")===!1)return;if(b.anisotropy>1||i.get(b).__currentAnisotropy){let K=t.get("EXT_texture_filter_anisotropic");n.texParameterf(P,K.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(b.anisotropy,s.getMaxAnisotropy())),i.get(b).__currentAnisotropy=b.anisotropy}}}function ie(P,b){let K=!1;P.__webglInit===void 0&&(P.__webglInit=!0,b.addEventListener("dispose",L),V(b));let gt=b.source,ft=d.get(gt);ft===void 0&&(ft={},d.set(gt,ft));let vt=Z(b);if(vt!==P.__cacheKey){ft[vt]===void 0&&(ft[vt]={texture:n.createTexture(),usedTimes:0},o.memory.textures++,K=!0),ft[vt].usedTimes++;let St=ft[P.__cacheKey];St!==void 0&&(ft[P.__cacheKey].usedTimes--,St.usedTimes===0&&G(b)),P.__cacheKey=vt,P.__webglTexture=ft[vt].texture}return K}function $t(P,b,K){return Math.floor(Math.floor(P/K)/b)}function Re(P,b,K,gt){let vt=P.updateRanges;if(vt.length===0)e.texSubImage2D(n.TEXTURE_2D,0,0,0,b.width,b.height,K,gt,b.data);else{vt.sort((z,ht)=>z.start-ht.start);let St=0;for(let z=1;z<vt.length;z++){let ht=vt[St],rt=vt[z],Et=ht.start+ht.count,xt=$t(rt.start,b.width,4),wt=$t(ht.start,b.width,4);rt.start<=Et+1&&xt===wt&&$t(rt.start+rt.count-1,b.width,4)===xt?ht.count=Math.max(ht.count,rt.start+rt.count-ht.start):(++St,vt[St]=rt)}vt.length=St+1;let st=e.getParameter(n.UNPACK_ROW_LENGTH),lt=e.getParameter(n.UNPACK_SKIP_PIXELS),yt=e.getParameter(n.UNPACK_SKIP_ROWS);e.pixelStorei(n.UNPACK_ROW_LENGTH,b.width);for(let z=0,ht=vt.length;z<ht;z++){let rt=vt[z],Et=Math.floor(rt.start/4),xt=Math.ceil(rt.count/4),wt=Et%b.width,Wt=Math.floor(Et/b.width),te=xt,mt=1;e.pixelStorei(n.UNPACK_SKIP_PIXELS,wt),e.pixelStorei(n.UNPACK_SKIP_ROWS,Wt),e.texSubImage2D(n.TEXTURE_2D,0,wt,Wt,te,mt,K,gt,b.data)}P.clearUpdateRanges(),e.pixelStorei(n.UNPACK_ROW_LENGTH,st),e.pixelStorei(n.UNPACK_SKIP_PIXELS,lt),e.pixelStorei(n.UNPACK_SKIP_ROWS,yt)}}function be(P,b,K){let gt=n.TEXTURE_2D;(b.isDataArrayTexture||b.isCompressedArrayTexture)&&(gt=n.TEXTURE_2D_ARRAY),b.isData3DTexture&&(gt=n.TEXTURE_3D);let ft=ie(P,b),vt=b.source;e.bindTexture(gt,P.__webglTexture,n.TEXTURE0+K);let St=i.get(vt);if(vt.version!==St.__version||ft===!0){if(e.activeTexture(n.TEXTURE0+K),(typeof ImageBitmap<"u"&&b.image instanceof ImageBitmap)===!1){let mt=ye.getPrimaries(ye.workingColorSpace),zt=b.colorSpace===Ls?null:ye.getPrimaries(b.colorSpace),ee=b.colorSpace===Ls||mt===zt?n.NONE:n.BROWSER_DEFAULT_WEBGL;e.pixelStorei(n.UNPACK_FLIP_Y_WEBGL,b.flipY),e.pixelStorei(n.UNPACK_PREMULTIPLY_ALPHA_WEBGL,b.premultiplyAlpha),e.pixelStorei(n.UNPACK_COLORSPACE_CONVERSION_WEBGL,ee)}e.pixelStorei(n.UNPACK_ALIGNMENT,b.unpackAlignment);let lt=v(b.image,!1,s.maxTextureSize);lt=Gt(b,lt);let yt=r.convert(b.format,b.colorSpace),z=r.convert(b.type),ht=E(b.internalFormat,yt,z,b.normalized,b.colorSpace,b.isVideoTexture);ne(gt,b);let rt,Et=b.mipmaps,xt=b.isVideoTexture!==!0,wt=St.__version===void 0||ft===!0,Wt=vt.dataReady,te=w(b,lt);if(b.isDepthTexture)ht=y(b.format===Ps,b.type),wt&&(xt?e.texStorage2D(n.TEXTURE_2D,1,ht,lt.width,lt.height):e.texImage2D(n.TEXTURE_2D,0,ht,lt.width,lt.height,0,yt,z,null));else if(b.isDataTexture)if(Et.length>0){xt&&wt&&e.texStorage2D(n.TEXTURE_2D,te,ht,Et[0].width,Et[0].height);for(let mt=0,zt=Et.length;mt<zt;mt++)rt=Et[mt],xt?Wt&&e.texSubImage2D(n.TEXTURE_2D,mt,0,0,rt.width,rt.height,yt,z,rt.data):e.texImage2D(n.TEXTURE_2D,mt,ht,rt.width,rt.height,0,yt,z,rt.data);b.generateMipmaps=!1}else xt?(wt&&e.texStorage2D(n.TEXTURE_2D,te,ht,lt.width,lt.height),Wt&&Re(b,lt,yt,z)):e.texImage2D(n.TEXTURE_2D,0,ht,lt.width,lt.height,0,yt,z,lt.data);else if(b.isCompressedTexture)if(b.isCompressedArrayTexture){xt&&wt&&e.texStorage3D(n.TEXTURE_2D_ARRAY,te,ht,Et[0].width,Et[0].height,lt.depth);for(let mt=0,zt=Et.length;mt<zt;mt++)if(rt=Et[mt],b.format!==Xi)if(yt!==null)if(xt){if(Wt)if(b.layerUpdates.size>0){let ee=pd(rt.width,rt.height,b.format,b.type);for(let Ct of b.layerUpdates){let ce=rt.data.subarray(Ct*ee/rt.data.BYTES_PER_ELEMENT,(Ct+1)*ee/rt.data.BYTES_PER_ELEMENT);e.compressedTexSubImage3D(n.TEXTURE_2D_ARRAY,mt,0,0,Ct,rt.width,rt.height,1,yt,ce)}}else e.compressedTexSubImage3D(n.TEXTURE_2D_ARRAY,mt,0,0,0,rt.width,rt.height,lt.depth,yt,rt.data)}else e.compressedTexImage3D(n.TEXTURE_2D_ARRAY,mt,ht,rt.width,rt.height,lt.depth,0,rt.data,0,0);else Kt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else xt?Wt&&e.texSubImage3D(n.TEXTURE_2D_ARRAY,mt,0,0,0,rt.width,rt.height,lt.depth,yt,z,rt.data):e.texImage3D(n.TEXTURE_2D_ARRAY,mt,ht,rt.width,rt.height,lt.depth,0,yt,z,rt.data);b.layerUpdates.size>0&&b.clearLayerUpdates()}else{xt&&wt&&e.texStorage2D(n.TEXTURE_2D,te,ht,Et[0].width,Et[0].height);for(let mt=0,zt=Et.length;mt<zt;mt++)rt=Et[mt],b.format!==Xi?yt!==null?xt?Wt&&e.compressedTexSubImage2D(n.TEXTURE_2D,mt,0,0,rt.width,rt.height,yt,rt.data):e.compressedTexImage2D(n.TEXTURE_2D,mt,ht,rt.width,rt.height,0,rt.data):Kt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):xt?Wt&&e.texSubImage2D(n.TEXTURE_2D,mt,0,0,rt.width,rt.height,yt,z,rt.data):e.texImage2D(n.TEXTURE_2D,mt,ht,rt.width,rt.height,0,yt,z,rt.data)}else if(b.isDataArrayTexture)if(xt){if(wt&&e.texStorage3D(n.TEXTURE_2D_ARRAY,te,ht,lt.width,lt.height,lt.depth),Wt)if(b.layerUpdates.size>0){let mt=pd(lt.width,lt.height,b.format,b.type);for(let zt of b.layerUpdates){let ee=lt.data.subarray(zt*mt/lt.data.BYTES_PER_ELEMENT,(zt+1)*mt/lt.data.BYTES_PER_ELEMENT);e.texSubImage3D(n.TEXTURE_2D_ARRAY,0,0,0,zt,lt.width,lt.height,1,yt,z,ee)}b.clearLayerUpdates()}else e.texSubImage3D(n.TEXTURE_2D_ARRAY,0,0,0,0,lt.width,lt.height,lt.depth,yt,z,lt.data)}else e.texImage3D(n.TEXTURE_2D_ARRAY,0,ht,lt.width,lt.height,lt.depth,0,yt,z,lt.data);else if(b.isData3DTexture)xt?(wt&&e.texStorage3D(n.TEXTURE_3D,te,ht,lt.width,lt.height,lt.depth),Wt&&e.texSubImage3D(n.TEXTURE_3D,0,0,0,0,lt.width,lt.height,lt.depth,yt,z,lt.data)):e.texImage3D(n.TEXTURE_3D,0,ht,lt.width,lt.height,lt.depth,0,yt,z,lt.data);else if(b.isFramebufferTexture){if(wt)if(xt)e.texStorage2D(n.TEXTURE_2D,te,ht,lt.width,lt.height);else{let mt=lt.width,zt=lt.height;for(let ee=0;ee<te;ee++)e.texImage2D(n.TEXTURE_2D,ee,ht,mt,zt,0,yt,z,null),mt>>=1,zt>>=1}}else if(b.isHTMLTexture){if("texElementImage2D"in n){let mt=n.canvas;if(mt.hasAttribute("layoutsubtree")||mt.setAttribute("layoutsubtree","true"),lt.parentNode!==mt){mt.appendChild(lt),f.add(b),mt.onpaint=zt=>{let ee=zt.changedElements;for(let Ct of f)ee.includes(Ct.image)&&(Ct.needsUpdate=!0)},mt.requestPaint();return}if(n.texElementImage2D.length===3)n.texElementImage2D(n.TEXTURE_2D,n.RGBA8,lt);else{let ee=n.RGBA,Ct=n.RGBA,ce=n.UNSIGNED_BYTE;n.texElementImage2D(n.TEXTURE_2D,0,ee,Ct,ce,lt)}n.texParameteri(n.TEXTURE_2D,n.TEXTURE_MIN_FILTER,n.LINEAR),n.texParameteri(n.TEXTURE_2D,n.TEXTURE_WRAP_S,n.CLAMP_TO_EDGE),n.texParameteri(n.TEXTURE_2D,n.TEXTURE_WRAP_T,n.CLAMP_TO_EDGE)}}else if(Et.length>0){if(xt&&wt){let mt=Yt(Et[0]);e.texStorage2D(n.TEXTURE_2D,te,ht,mt.width,mt.height)}for(let mt=0,zt=Et.length;mt<zt;mt++)rt=Et[mt],xt?Wt&&e.texSubImage2D(n.TEXTURE_2D,mt,0,0,yt,z,rt):e.texImage2D(n.TEXTURE_2D,mt,ht,yt,z,rt);b.generateMipmaps=!1}else if(xt){if(wt){let mt=Yt(lt);e.texStorage2D(n.TEXTURE_2D,te,ht,mt.width,mt.height)}Wt&&e.texSubImage2D(n.TEXTURE_2D,0,0,0,yt,z,lt)}else e.texImage2D(n.TEXTURE_2D,0,ht,yt,z,lt);T(b)&&b.mipmapsAutoUpdate===!0&&S(gt),St.__version=vt.version,b.onUpdate&&b.onUpdate(b)}P.__version=b.version}function Ve(P,b,K){if(b.image.length!==6)return;let gt=ie(P,b),ft=b.source;e.bindTexture(n.TEXTURE_CUBE_MAP,P.__webglTexture,n.TEXTURE0+K);let vt=i.get(ft);if(ft.version!==vt.__version||gt===!0){e.activeTexture(n.TEXTURE0+K);let St=ye.getPrimaries(ye.workingColorSpace),st=b.colorSpace===Ls?null:ye.getPrimaries(b.colorSpace),lt=b.colorSpace===Ls||St===st?n.NONE:n.BROWSER_DEFAULT_WEBGL;e.pixelStorei(n.UNPACK_FLIP_Y_WEBGL,b.flipY),e.pixelStorei(n.UNPACK_PREMULTIPLY_ALPHA_WEBGL,b.premultiplyAlpha),e.pixelStorei(n.UNPACK_ALIGNMENT,b.unpackAlignment),e.pixelStorei(n.UNPACK_COLORSPACE_CONVERSION_WEBGL,lt);let yt=b.isCompressedTexture||b.image[0].isCompressedTexture,z=b.image[0]&&b.image[0].isDataTexture,ht=[];for(let Ct=0;Ct<6;Ct++)!yt&&!z?ht[Ct]=v(b.image[Ct],!0,s.maxCubemapSize):ht[Ct]=z?b.image[Ct].image:b.image[Ct],ht[Ct]=Gt(b,ht[Ct]);let rt=ht[0],Et=r.convert(b.format,b.colorSpace),xt=r.convert(b.type),wt=E(b.internalFormat,Et,xt,b.normalized,b.colorSpace),Wt=b.isVideoTexture!==!0,te=vt.__version===void 0||gt===!0,mt=ft.dataReady,zt=w(b,rt);ne(n.TEXTURE_CUBE_MAP,b);let ee;if(b.isDepthTexture){if(wt=y(b.format===Ps,b.type),te)if(Wt)e.texStorage2D(n.TEXTURE_CUBE_MAP,1,wt,rt.width,rt.height);else for(let Ct=0;Ct<6;Ct++)e.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,wt,rt.width,rt.height,0,Et,xt,null)}else if(yt){Wt&&te&&e.texStorage2D(n.TEXTURE_CUBE_MAP,zt,wt,rt.width,rt.height);for(let Ct=0;Ct<6;Ct++){ee=ht[Ct].mipmaps;for(let ce=0;ce<ee.length;ce++){let Ge=ee[ce];b.format!==Xi?Et!==null?Wt?mt&&e.compressedTexSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce,0,0,Ge.width,Ge.height,Et,Ge.data):e.compressedTexImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce,wt,Ge.width,Ge.height,0,Ge.data):Kt("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):Wt?mt&&e.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce,0,0,Ge.width,Ge.height,Et,xt,Ge.data):e.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce,wt,Ge.width,Ge.height,0,Et,xt,Ge.data)}}}else{if(ee=b.mipmaps,Wt&&te){ee.length>0&&zt++;let Ct=Yt(ht[0]);e.texStorage2D(n.TEXTURE_CUBE_MAP,zt,wt,Ct.width,Ct.height)}for(let Ct=0;Ct<6;Ct++)if(z){Wt?mt&&e.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,0,0,ht[Ct].width,ht[Ct].height,Et,xt,ht[Ct].data):e.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,wt,ht[Ct].width,ht[Ct].height,0,Et,xt,ht[Ct].data);for(let ce=0;ce<ee.length;ce++){let Zn=ee[ce].image[Ct].image;Wt?mt&&e.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce+1,0,0,Zn.width,Zn.height,Et,xt,Zn.data):e.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce+1,wt,Zn.width,Zn.height,0,Et,xt,Zn.data)}}else{Wt?mt&&e.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,0,0,Et,xt,ht[Ct]):e.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,wt,Et,xt,ht[Ct]);for(let ce=0;ce<ee.length;ce++){let Ge=ee[ce];Wt?mt&&e.texSubImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce+1,0,0,Et,xt,Ge.image[Ct]):e.texImage2D(n.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ce+1,wt,Et,xt,Ge.image[Ct])}}}T(b)&&b.mipmapsAutoUpdate===!0&&S(n.TEXTURE_CUBE_MAP),vt.__version=ft.version,b.onUpdate&&b.onUpdate(b)}P.__version=b.version}function we(P,b,K,gt,ft,vt){let St=r.convert(K.format,K.colorSpace),st=r.convert(K.type),lt=E(K.internalFormat,St,st,K.normalized,K.colorSpace),yt=i.get(b),z=i.get(K);if(z.__renderTarget=b,!yt.__hasExternalTextures){let ht=Math.max(1,b.width>>vt),rt=Math.max(1,b.height>>vt);ft===n.TEXTURE_3D||ft===n.TEXTURE_2D_ARRAY?e.texImage3D(ft,vt,lt,ht,rt,b.depth,0,St,st,null):e.texImage2D(ft,vt,lt,ht,rt,0,St,st,null)}e.bindFramebuffer(n.FRAMEBUFFER,P),Mt(b)?a.framebufferTexture2DMultisampleEXT(n.FRAMEBUFFER,gt,ft,z.__webglTexture,0,le(b)):(ft===n.TEXTURE_2D||ft>=n.TEXTURE_CUBE_MAP_POSITIVE_X&&ft<=n.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&n.framebufferTexture2D(n.FRAMEBUFFER,gt,ft,z.__webglTexture,vt),e.bindFramebuffer(n.FRAMEBUFFER,null)}function cn(P,b,K){if(n.bindRenderbuffer(n.RENDERBUFFER,P),b.depthBuffer){let gt=b.depthTexture,ft=gt&&gt.isDepthTexture?gt.type:null,vt=y(b.stencilBuffer,ft),St=b.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT;Mt(b)?a.renderbufferStorageMultisampleEXT(n.RENDERBUFFER,le(b),vt,b.width,b.height):K?n.renderbufferStorageMultisample(n.RENDERBUFFER,le(b),vt,b.width,b.height):n.renderbufferStorage(n.RENDERBUFFER,vt,b.width,b.height),n.framebufferRenderbuffer(n.FRAMEBUFFER,St,n.RENDERBUFFER,P)}else{let gt=b.textures;for(let ft=0;ft<gt.length;ft++){let vt=gt[ft],St=r.convert(vt.format,vt.colorSpace),st=r.convert(vt.type),lt=E(vt.internalFormat,St,st,vt.normalized,vt.colorSpace);Mt(b)?a.renderbufferStorageMultisampleEXT(n.RENDERBUFFER,le(b),lt,b.width,b.height):K?n.renderbufferStorageMultisample(n.RENDERBUFFER,le(b),lt,b.width,b.height):n.renderbufferStorage(n.RENDERBUFFER,lt,b.width,b.height)}}n.bindRenderbuffer(n.RENDERBUFFER,null)}function Se(P,b,K){let gt=b.isWebGLCubeRenderTarget===!0;if(e.bindFramebuffer(n.FRAMEBUFFER,P),!(b.depthTexture&&b.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");let ft=i.get(b.depthTexture);ft.__renderTarget=b;let vt=gt?b.depthTexture.image[0]:b.depthTexture.image;(!ft.__webglTexture||vt.width!==b.width||vt.height!==b.height)&&(vt.width=b.width,vt.height=b.height,b.depthTexture.needsUpdate=!0),gt?ot(b.depthTexture,0):at(b.depthTexture,0);let St=ft.__webglTexture,st=le(b),lt=gt?n.TEXTURE_CUBE_MAP_POSITIVE_X+K:n.TEXTURE_2D,yt=b.depthTexture.format===Ps?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT;if(b.depthTexture.format===Es)Mt(b)?a.framebufferTexture2DMultisampleEXT(n.FRAMEBUFFER,yt,lt,St,0,st):n.framebufferTexture2D(n.FRAMEBUFFER,yt,lt,St,0);else if(b.depthTexture.format===Ps)Mt(b)?a.framebufferTexture2DMultisampleEXT(n.FRAMEBUFFER,yt,lt,St,0,st):n.framebufferTexture2D(n.FRAMEBUFFER,yt,lt,St,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function yn(P){let b=i.get(P),K=P.isWebGLCubeRenderTarget===!0;if(b.__boundDepthTexture!==P.depthTexture){let gt=P.depthTexture;if(b.__depthDisposeCallback&&b.__depthDisposeCallback(),gt){let ft=()=>{delete b.__boundDepthTexture,delete b.__depthDisposeCallback,gt.removeEventListener("dispose",ft)};gt.addEventListener("dispose",ft),b.__depthDisposeCallback=ft}b.__boundDepthTexture=gt}if(P.depthTexture&&!b.__autoAllocateDepthBuffer)if(K)for(let gt=0;gt<6;gt++)Se(b.__webglFramebuffer[gt],P,gt);else P.texture.mipmaps.length>0?Se(b.__webglFramebuffer[0],P,0):Se(b.__webglFramebuffer,P,0);else if(K){b.__webglDepthbuffer=[];for(let gt=0;gt<6;gt++)if(e.bindFramebuffer(n.FRAMEBUFFER,b.__webglFramebuffer[gt]),b.__webglDepthbuffer[gt]===void 0)b.__webglDepthbuffer[gt]=n.createRenderbuffer(),cn(b.__webglDepthbuffer[gt],P,!1);else{let ft=P.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT,vt=b.__webglDepthbuffer[gt];n.bindRenderbuffer(n.RENDERBUFFER,vt),n.framebufferRenderbuffer(n.FRAMEBUFFER,ft,n.RENDERBUFFER,vt)}}else if(P.texture.mipmaps.length>0?e.bindFramebuffer(n.FRAMEBUFFER,b.__webglFramebuffer[0]):e.bindFramebuffer(n.FRAMEBUFFER,b.__webglFramebuffer),b.__webglDepthbuffer===void 0)b.__webglDepthbuffer=n.createRenderbuffer(),cn(b.__webglDepthbuffer,P,!1);else{let ft=P.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT,vt=b.__webglDepthbuffer;n.bindRenderbuffer(n.RENDERBUFFER,vt),n.framebufferRenderbuffer(n.FRAMEBUFFER,ft,n.RENDERBUFFER,vt)}e.bindFramebuffer(n.FRAMEBUFFER,null)}function en(P,b,K){let gt=i.get(P);b!==void 0&&we(gt.__webglFramebuffer,P,P.texture,n.COLOR_ATTACHMENT0,n.TEXTURE_2D,0),K!==void 0&&yn(P)}function hn(P){let b=P.texture,K=i.get(P),gt=i.get(b);P.addEventListener("dispose",B),V(P);let ft=P.textures,vt=P.isWebGLCubeRenderTarget===!0,St=ft.length>1;if(St||(gt.__webglTexture===void 0&&(gt.__webglTexture=n.createTexture()),gt.__version=b.version,o.memory.textures++),vt){K.__webglFramebuffer=[];for(let st=0;st<6;st++)if(b.mipmaps.length>0){K.__webglFramebuffer[st]=[];for(let lt=0;lt<b.mipmaps.length;lt++)K.__webglFramebuffer[st][lt]=n.createFramebuffer()}else K.__webglFramebuffer[st]=n.createFramebuffer()}else{if(b.mipmaps.length>0){K.__webglFramebuffer=[];for(let st=0;st<b.mipmaps.length;st++)K.__webglFramebuffer[st]=n.createFramebuffer()}else K.__webglFramebuffer=n.createFramebuffer();if(St)for(let st=0,lt=ft.length;st<lt;st++){let yt=i.get(ft[st]);yt.__webglTexture===void 0&&(yt.__webglTexture=n.createTexture(),o.memory.textures++)}if(P.samples>0&&Mt(P)===!1){K.__webglMultisampledFramebuffer=n.createFramebuffer(),K.__webglColorRenderbuffer=[],e.bindFramebuffer(n.FRAMEBUFFER,K.__webglMultisampledFramebuffer);for(let st=0;st<ft.length;st++){let lt=ft[st];K.__webglColorRenderbuffer[st]=n.createRenderbuffer(),n.bindRenderbuffer(n.RENDERBUFFER,K.__webglColorRenderbuffer[st]);let yt=r.convert(lt.format,lt.colorSpace),z=r.convert(lt.type),ht=E(lt.internalFormat,yt,z,lt.normalized,lt.colorSpace,P.isXRRenderTarget===!0),rt=le(P);n.renderbufferStorageMultisample(n.RENDERBUFFER,rt,ht,P.width,P.height),n.framebufferRenderbuffer(n.FRAMEBUFFER,n.COLOR_ATTACHMENT0+st,n.RENDERBUFFER,K.__webglColorRenderbuffer[st])}n.bindRenderbuffer(n.RENDERBUFFER,null),P.depthBuffer&&(K.__webglDepthRenderbuffer=n.createRenderbuffer(),cn(K.__webglDepthRenderbuffer,P,!0)),e.bindFramebuffer(n.FRAMEBUFFER,null)}}if(vt){e.bindTexture(n.TEXTURE_CUBE_MAP,gt.__webglTexture),ne(n.TEXTURE_CUBE_MAP,b);for(let st=0;st<6;st++)if(b.mipmaps.length>0)for(let lt=0;lt<b.mipmaps.length;lt++)we(K.__webglFramebuffer[st][lt],P,b,n.COLOR_ATTACHMENT0,n.TEXTURE_CUBE_MAP_POSITIVE_X+st,lt);else we(K.__webglFramebuffer[st],P,b,n.COLOR_ATTACHMENT0,n.TEXTURE_CUBE_MAP_POSITIVE_X+st,0);T(b)?S(n.TEXTURE_CUBE_MAP):b.mipmaps.length>0&&n.texParameteri(n.TEXTURE_CUBE_MAP,n.TEXTURE_MAX_LEVEL,b.mipmaps.length-1),e.unbindTexture()}else if(St){for(let st=0,lt=ft.length;st<lt;st++){let yt=ft[st],z=i.get(yt),ht=n.TEXTURE_2D;(P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(ht=P.isWebGL3DRenderTarget?n.TEXTURE_3D:n.TEXTURE_2D_ARRAY),e.bindTexture(ht,z.__webglTexture),ne(ht,yt),we(K.__webglFramebuffer,P,yt,n.COLOR_ATTACHMENT0+st,ht,0),T(yt)&&S(ht)}e.unbindTexture()}else{let st=n.TEXTURE_2D;if((P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(st=P.isWebGL3DRenderTarget?n.TEXTURE_3D:n.TEXTURE_2D_ARRAY),e.bindTexture(st,gt.__webglTexture),ne(st,b),b.mipmaps.length>0)for(let lt=0;lt<b.mipmaps.length;lt++)we(K.__webglFramebuffer[lt],P,b,n.COLOR_ATTACHMENT0,st,lt);else we(K.__webglFramebuffer,P,b,n.COLOR_ATTACHMENT0,st,0);T(b)?S(st):b.mipmaps.length>0&&n.texParameteri(st,n.TEXTURE_MAX_LEVEL,b.mipmaps.length-1),e.unbindTexture()}P.depthBuffer&&yn(P)}function H(P){let b=P.textures;for(let K=0,gt=b.length;K<gt;K++){let ft=b[K];if(T(ft)&&ft.mipmapsAutoUpdate===!0){let vt=C(P),St=i.get(ft).__webglTexture;e.bindTexture(vt,St),S(vt),e.unbindTexture()}}}let Rt=[];function Jt(P){if(P.samples>0){if(Mt(P)===!1){let b=P.textures,K=P.width,gt=P.height,ft=n.COLOR_BUFFER_BIT,vt=P.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT,St=i.get(P),st=b.length>1;if(st)for(let yt=0;yt<b.length;yt++)e.bindFramebuffer(n.FRAMEBUFFER,St.__webglMultisampledFramebuffer),n.framebufferRenderbuffer(n.FRAMEBUFFER,n.COLOR_ATTACHMENT0+yt,n.RENDERBUFFER,null),e.bindFramebuffer(n.FRAMEBUFFER,St.__webglFramebuffer),n.framebufferTexture2D(n.DRAW_FRAMEBUFFER,n.COLOR_ATTACHMENT0+yt,n.TEXTURE_2D,null,0);e.bindFramebuffer(n.READ_FRAMEBUFFER,St.__webglMultisampledFramebuffer),P.texture.mipmaps.length>0?e.bindFramebuffer(n.DRAW_FRAMEBUFFER,St.__webglFramebuffer[0]):e.bindFramebuffer(n.DRAW_FRAMEBUFFER,St.__webglFramebuffer);for(let yt=0;yt<b.length;yt++){if(P.resolveDepthBuffer&&(P.depthBuffer&&(ft|=n.DEPTH_BUFFER_BIT),P.stencilBuffer&&P.resolveStencilBuffer&&(ft|=n.STENCIL_BUFFER_BIT)),st){n.framebufferRenderbuffer(n.READ_FRAMEBUFFER,n.COLOR_ATTACHMENT0,n.RENDERBUFFER,St.__webglColorRenderbuffer[yt]);let z=i.get(b[yt]).__webglTexture;n.framebufferTexture2D(n.DRAW_FRAMEBUFFER,n.COLOR_ATTACHMENT0,n.TEXTURE_2D,z,0)}n.blitFramebuffer(0,0,K,gt,0,0,K,gt,ft,n.NEAREST),c===!0&&(Rt.length=0,Rt.push(n.COLOR_ATTACHMENT0+yt),P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&Rt.push(vt),n.invalidateFramebuffer(n.READ_FRAMEBUFFER,Rt))}if(e.bindFramebuffer(n.READ_FRAMEBUFFER,null),e.bindFramebuffer(n.DRAW_FRAMEBUFFER,null),st)for(let yt=0;yt<b.length;yt++){e.bindFramebuffer(n.FRAMEBUFFER,St.__webglMultisampledFramebuffer),n.framebufferRenderbuffer(n.FRAMEBUFFER,n.COLOR_ATTACHMENT0+yt,n.RENDERBUFFER,St.__webglColorRenderbuffer[yt]);let z=i.get(b[yt]).__webglTexture;e.bindFramebuffer(n.FRAMEBUFFER,St.__webglFramebuffer),n.framebufferTexture2D(n.DRAW_FRAMEBUFFER,n.COLOR_ATTACHMENT0+yt,n.TEXTURE_2D,z,0)}e.bindFramebuffer(n.DRAW_FRAMEBUFFER,St.__webglMultisampledFramebuffer)}else if(P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&c){let b=P.stencilBuffer?n.DEPTH_STENCIL_ATTACHMENT:n.DEPTH_ATTACHMENT;n.invalidateFramebuffer(n.DRAW_FRAMEBUFFER,[b])}}}function le(P){return Math.min(s.maxSamples,P.samples)}function Mt(P){let b=i.get(P);return P.samples>0&&t.has("WEBGL_multisampled_render_to_texture")===!0&&b.__useRenderToTexture!==!1}function ke(P){let b=o.render.frame;h.get(P)!==b&&(h.set(P,b),P.update())}function Gt(P,b){let K=P.colorSpace,gt=P.format,ft=P.type;return P.isCompressedTexture===!0||P.isVideoTexture===!0||K!==ba&&K!==Ls&&(ye.getTransfer(K)===Ie?(gt!==Xi||ft!==hi)&&Kt("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):re("WebGLTextures: Unsupported texture color space:",K)),b}function Yt(P){return typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement?(l.width=P.naturalWidth||P.width,l.height=P.naturalHeight||P.height):typeof VideoFrame<"u"&&P instanceof VideoFrame?(l.width=P.displayWidth,l.height=P.displayHeight):(l.width=P.width,l.height=P.height),l}this.allocateTextureUnit=nt,this.resetTextureUnits=k,this.getTextureUnits=Y,this.setTextureUnits=et,this.setTexture2D=at,this.setTexture2DArray=ut,this.setTexture3D=dt,this.setTextureCube=ot,this.rebindTextures=en,this.setupRenderTarget=hn,this.updateRenderTargetMipmap=H,this.updateMultisampleRenderTarget=Jt,this.setupDepthRenderbuffer=yn,this.setupFrameBufferTexture=we,this.useMultisampledRTT=Mt,this.dispose=U}function UA(n,t){function e(i,s=Ls){let r,o=ye.getTransfer(s);if(i===hi)return n.UNSIGNED_BYTE;if(i===Kc)return n.UNSIGNED_SHORT_4_4_4_4;if(i===Jc)return n.UNSIGNED_SHORT_5_5_5_1;if(i===Jf)return n.UNSIGNED_INT_5_9_9_9_REV;if(i===jf)return n.UNSIGNED_INT_10F_11F_11F_REV;if(i===Zf)return n.BYTE;if(i===Kf)return n.SHORT;if(i===Ao)return n.UNSIGNED_SHORT;if(i===Zc)return n.INT;if(i===Gi)return n.UNSIGNED_INT;if(i===Wi)return n.FLOAT;if(i===$i)return n.HALF_FLOAT;if(i===Qf)return n.ALPHA;if(i===td)return n.RGB;if(i===Xi)return n.RGBA;if(i===Es)return n.DEPTH_COMPONENT;if(i===Ps)return n.DEPTH_STENCIL;if(i===ed)return n.RED;if(i===jc)return n.RED_INTEGER;if(i===ar)return n.RG;if(i===Qc)return n.RG_INTEGER;if(i===th)return n.RGBA_INTEGER;if(i===qa||i===Ya||i===Za||i===Ka)if(o===Ie)if(r=t.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(i===qa)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(i===Ya)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(i===Za)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(i===Ka)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=t.get("WEBGL_compressed_texture_s3tc"),r!==null){if(i===qa)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(i===Ya)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(i===Za)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(i===Ka)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(i===eh||i===nh||i===ih||i===sh)if(r=t.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(i===eh)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(i===nh)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(i===ih)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(i===sh)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(i===rh||i===oh||i===ah||i===lh||i===ch||i===Ja||i===hh)if(r=t.get("WEBGL_compressed_texture_etc"),r!==null){if(i===rh||i===oh)return o===Ie?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(i===ah)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(i===lh)return r.COMPRESSED_R11_EAC;if(i===ch)return r.COMPRESSED_SIGNED_R11_EAC;if(i===Ja)return r.COMPRESSED_RG11_EAC;if(i===hh)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(i===uh||i===fh||i===dh||i===ph||i===mh||i===gh||i===_h||i===yh||i===xh||i===vh||i===Sh||i===bh||i===wh||i===Mh)if(r=t.get("WEBGL_compressed_texture_astc"),r!==null){if(i===uh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(i===fh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(i===dh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(i===ph)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(i===mh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(i===gh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(i===_h)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(i===yh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(i===xh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(i===vh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(i===Sh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(i===bh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(i===wh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(i===Mh)return o===Ie?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(i===Eh||i===Ah||i===Th)if(r=t.get("EXT_texture_compression_bptc"),r!==null){if(i===Eh)return o===Ie?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(i===Ah)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(i===Th)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(i===Ch||i===Rh||i===ja||i===Ih)if(r=t.get("EXT_texture_compression_rgtc"),r!==null){if(i===Ch)return r.COMPRESSED_RED_RGTC1_EXT;if(i===Rh)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(i===ja)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(i===Ih)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return i===Er?n.UNSIGNED_INT_24_8:n[i]!==void 0?n[i]:null}return{convert:e}}var FA=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,BA=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,wd=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(t,e){if(this.texture===null){let i=new Da(t.texture);(t.depthNear!==e.depthNear||t.depthFar!==e.depthFar)&&(this.depthNear=t.depthNear,this.depthFar=t.depthFar),this.texture=i}}getMesh(t){if(this.texture!==null&&this.mesh===null){let e=t.cameras[0].viewport,i=new Pi({vertexShader:FA,fragmentShader:BA,uniforms:{depthColor:{value:this.texture},depthWidth:{value:e.z},depthHeight:{value:e.w}}});this.mesh=new ni(new Ua(20,20),i)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},Md=class extends Vi{constructor(t,e){super();let i=this,s=null,r=1,o=null,a="local-floor",c=1,l=null,h=null,f=null,u=null,d=null,p=null,_=typeof XRWebGLBinding<"u",m=new wd,g={},v=e.getContextAttributes(),T=null,S=null,C=[],E=[],y=new jt,w=null,V=null,N=new ti;N.viewport=new Je;let L=new ti;L.viewport=new Je;let B=[N,L],F=new Wc,R=null,U=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(Z){let at=C[Z];return at===void 0&&(at=new mo,C[Z]=at),at.getTargetRaySpace()},this.getControllerGrip=function(Z){let at=C[Z];return at===void 0&&(at=new mo,C[Z]=at),at.getGripSpace()},this.getHand=function(Z){let at=C[Z];return at===void 0&&(at=new mo,C[Z]=at),at.getHandSpace()};function X(Z){let at=E.indexOf(Z.inputSource);if(at===-1)return;let ut=C[at];ut!==void 0&&(ut.update(Z.inputSource,Z.frame,l||o),ut.dispatchEvent({type:Z.type,data:Z.inputSource}))}function G(){s.removeEventListener("select",X),s.removeEventListener("selectstart",X),s.removeEventListener("selectend",X),s.removeEventListener("squeeze",X),s.removeEventListener("squeezestart",X),s.removeEventListener("squeezeend",X),s.removeEventListener("end",G),s.removeEventListener("inputsourceschange",ct);for(let Z=0;Z<C.length;Z++){let at=E[Z];at!==null&&(E[Z]=null,C[Z].disconnect(at))}R=null,U=null,m.reset();for(let Z in g)delete g[Z];if(t.setRenderTarget(T),d=null,u=null,f=null,s=null,S=null,nt.stop(),i.isPresenting=!1,t.setPixelRatio(w),t.setSize(y.width,y.height,!1),V!==null){let Z=V.camera;Z.fov=V.fov,Z.zoom=V.zoom,Z.updateProjectionMatrix(),V=null}i.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(Z){r=Z,i.isPresenting===!0&&Kt("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(Z){a=Z,i.isPresenting===!0&&Kt("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return l||o},this.setReferenceSpace=function(Z){l=Z},this.getBaseLayer=function(){return u!==null?u:d},this.getBinding=function(){return f===null&&_&&(f=new XRWebGLBinding(s,e)),f},this.getFrame=function(){return p},this.getSession=function(){return s},this.setSession=async function(Z){if(s=Z,s!==null){if(T=t.getRenderTarget(),s.addEventListener("select",X),s.addEventListener("selectstart",X),s.addEventListener("selectend",X),s.addEventListener("squeeze",X),s.addEventListener("squeezestart",X),s.addEventListener("squeezeend",X),s.addEventListener("end",G),s.addEventListener("inputsourceschange",ct),v.xrCompatible!==!0&&await e.makeXRCompatible(),w=t.getPixelRatio(),t.getSize(y),_&&"createProjectionLayer"in XRWebGLBinding.prototype){let ut=null,dt=null,ot=null;v.depth&&(ot=v.stencil?e.DEPTH24_STENCIL8:e.DEPTH_COMPONENT24,ut=v.stencil?Ps:Es,dt=v.stencil?Er:Gi);let Lt={colorFormat:e.RGBA8,depthFormat:ot,scaleFactor:r};f=this.getBinding(),u=f.createProjectionLayer(Lt),s.updateRenderState({layers:[u]}),t.setPixelRatio(1),t.setSize(u.textureWidth,u.textureHeight,!1),S=new vi(u.textureWidth,u.textureHeight,{format:Xi,type:hi,depthTexture:new Rs(u.textureWidth,u.textureHeight,dt,void 0,void 0,void 0,void 0,void 0,void 0,ut),stencilBuffer:v.stencil,colorSpace:t.outputColorSpace,samples:v.antialias?4:0,resolveDepthBuffer:u.ignoreDepthValues===!1,resolveStencilBuffer:u.ignoreDepthValues===!1,storeMultisampledDepthBuffer:u.ignoreDepthValues===!1,storeMultisampledStencilBuffer:u.ignoreDepthValues===!1})}else{let ut={antialias:v.antialias,alpha:!0,depth:v.depth,stencil:v.stencil,framebufferScaleFactor:r};d=new XRWebGLLayer(s,e,ut),s.updateRenderState({baseLayer:d}),t.setPixelRatio(1),t.setSize(d.framebufferWidth,d.framebufferHeight,!1),S=new vi(d.framebufferWidth,d.framebufferHeight,{format:Xi,type:hi,colorSpace:t.outputColorSpace,stencilBuffer:v.stencil,resolveDepthBuffer:d.ignoreDepthValues===!1,resolveStencilBuffer:d.ignoreDepthValues===!1,storeMultisampledDepthBuffer:d.ignoreDepthValues===!1,storeMultisampledStencilBuffer:d.ignoreDepthValues===!1})}S.isXRRenderTarget=!0,this.setFoveation(c),l=null,o=await s.requestReferenceSpace(a),nt.setContext(s),nt.start(),i.isPresenting=!0,i.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return m.getDepthTexture()};function ct(Z){for(let at=0;at<Z.removed.length;at++){let ut=Z.removed[at],dt=E.indexOf(ut);dt>=0&&(E[dt]=null,C[dt].disconnect(ut))}for(let at=0;at<Z.added.length;at++){let ut=Z.added[at],dt=E.indexOf(ut);if(dt===-1){for(let Lt=0;Lt<C.length;Lt++)if(Lt>=E.length){E.push(ut),dt=Lt;break}else if(E[Lt]===null){E[Lt]=ut,dt=Lt;break}if(dt===-1)break}let ot=C[dt];ot&&ot.connect(ut)}}function I(Z,at){at===null?Z.matrixWorld.copy(Z.matrix):Z.matrixWorld.multiplyMatrices(at.matrixWorld,Z.matrix),Z.matrixWorldInverse.copy(Z.matrixWorld).invert()}this.updateCamera=function(Z){if(s===null)return;let at=Z.near,ut=Z.far;m.texture!==null&&(m.depthNear>0&&(at=m.depthNear),m.depthFar>0&&(ut=m.depthFar)),F.near=L.near=N.near=at,F.far=L.far=N.far=ut,(R!==F.near||U!==F.far)&&(s.updateRenderState({depthNear:F.near,depthFar:F.far}),R=F.near,U=F.far),F.layers.mask=Z.layers.mask|6,N.layers.mask=F.layers.mask&-5,L.layers.mask=F.layers.mask&-3;let dt=Z.parent,ot=F.cameras;I(F,dt);for(let Lt=0;Lt<ot.length;Lt++)I(ot[Lt],dt);F.projectionMatrix.copy(N.projectionMatrix),F.projectionMatrixInverse.copy(N.projectionMatrixInverse),V===null&&Z.isPerspectiveCamera&&(V={camera:Z,fov:Z.fov,zoom:Z.zoom}),k(Z,F,dt)};function k(Z,at,ut){ut===null?Z.matrix.copy(at.matrixWorld):(Z.matrix.copy(ut.matrixWorld),Z.matrix.invert(),Z.matrix.multiply(at.matrixWorld)),Z.matrix.decompose(Z.position,Z.quaternion,Z.scale),Z.updateMatrixWorld(!0),Z.projectionMatrix.copy(at.projectionMatrix),Z.projectionMatrixInverse.copy(at.projectionMatrixInverse),Z.isPerspectiveCamera&&(Z.fov=fo*2*Math.atan(1/Z.projectionMatrix.elements[5]),Z.zoom=1)}this.getCamera=function(){return F},this.getFoveation=function(){if(!(u===null&&d===null))return c},this.setFoveation=function(Z){c=Z,u!==null&&(u.fixedFoveation=Z),d!==null&&d.fixedFoveation!==void 0&&(d.fixedFoveation=Z)},this.hasDepthSensing=function(){return m.texture!==null},this.getDepthSensingMesh=function(){return m.getMesh(F)},this.getCameraTexture=function(Z){return g[Z]};let Y=null;function et(Z,at){if(h=at.getViewerPose(l||o),p=at,h!==null){let ut=h.views;d!==null&&(t.setRenderTargetFramebuffer(S,d.framebuffer),t.setRenderTarget(S));let dt=!1;ut.length!==F.cameras.length&&(F.cameras.length=0,dt=!0);for(let Ut=0;Ut<ut.length;Ut++){let ne=ut[Ut],ie=null;if(d!==null)ie=d.getViewport(ne);else{let Re=f.getViewSubImage(u,ne);ie=Re.viewport,Ut===0&&(t.setRenderTargetTextures(S,Re.colorTexture,Re.depthStencilTexture),t.setRenderTarget(S))}let $t=B[Ut];$t===void 0&&($t=new ti,$t.layers.enable(Ut),$t.viewport=new Je,B[Ut]=$t),$t.matrix.fromArray(ne.transform.matrix),$t.matrix.decompose($t.position,$t.quaternion,$t.scale),$t.projectionMatrix.fromArray(ne.projectionMatrix),$t.projectionMatrixInverse.copy($t.projectionMatrix).invert(),$t.viewport.set(ie.x,ie.y,ie.width,ie.height),Ut===0&&(F.matrix.copy($t.matrix),F.matrix.decompose(F.position,F.quaternion,F.scale)),dt===!0&&F.cameras.push($t)}let ot=s.enabledFeatures;if(ot&&ot.includes("depth-sensing")&&s.depthUsage=="gpu-optimized"&&_){f=i.getBinding();let Ut=f.getDepthInformation(ut[0]);Ut&&Ut.isValid&&Ut.texture&&m.init(Ut,s.renderState)}if(ot&&ot.includes("camera-access")&&_){t.state.unbindTexture(),f=i.getBinding();for(let Ut=0;Ut<ut.length;Ut++){let ne=ut[Ut].camera;if(ne){let ie=g[ne];ie||(ie=new Da,g[ne]=ie);let $t=f.getCameraImage(ne);ie.sourceTexture=$t}}}}for(let ut=0;ut<C.length;ut++){let dt=E[ut],ot=C[ut];dt!==null&&ot!==void 0&&ot.update(dt,at,l||o)}Y&&Y(Z,at),at.detectedPlanes&&i.dispatchEvent({type:"planesdetected",data:at}),p=null}let nt=new w0;nt.setAnimationLoop(et),this.setAnimationLoop=function(Z){Y=Z},this.dispose=function(){}}},kA=new Be,D0=new oe;D0.set(-1,0,0,0,1,0,0,0,1);function zA(n,t){function e(m,g){m.matrixAutoUpdate===!0&&m.updateMatrix(),g.value.copy(m.matrix)}function i(m,g){g.color.getRGB(m.fogColor.value,ud(n)),g.isFog?(m.fogNear.value=g.near,m.fogFar.value=g.far):g.isFogExp2&&(m.fogDensity.value=g.density)}function s(m,g,v,T,S){g.isNodeMaterial?g.uniformsNeedUpdate=!1:g.isMeshBasicMaterial?r(m,g):g.isMeshLambertMaterial?(r(m,g),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)):g.isMeshToonMaterial?(r(m,g),f(m,g)):g.isMeshPhongMaterial?(r(m,g),h(m,g),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)):g.isMeshStandardMaterial?(r(m,g),u(m,g),g.isMeshPhysicalMaterial&&d(m,g,S)):g.isMeshMatcapMaterial?(r(m,g),p(m,g)):g.isMeshDepthMaterial?r(m,g):g.isMeshDistanceMaterial?(r(m,g),_(m,g)):g.isMeshNormalMaterial?r(m,g):g.isLineBasicMaterial?(o(m,g),g.isLineDashedMaterial&&a(m,g)):g.isPointsMaterial?c(m,g,v,T):g.isSpriteMaterial?l(m,g):g.isShadowMaterial?(m.color.value.copy(g.color),m.opacity.value=g.opacity):g.isShaderMaterial&&(g.uniformsNeedUpdate=!1)}function r(m,g){m.opacity.value=g.opacity,g.color&&m.diffuse.value.copy(g.color),g.emissive&&m.emissive.value.copy(g.emissive).multiplyScalar(g.emissiveIntensity),g.map&&(m.map.value=g.map,e(g.map,m.mapTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.bumpMap&&(m.bumpMap.value=g.bumpMap,e(g.bumpMap,m.bumpMapTransform),m.bumpScale.value=g.bumpScale,g.side===ii&&(m.bumpScale.value*=-1)),g.normalMap&&(m.normalMap.value=g.normalMap,e(g.normalMap,m.normalMapTransform),m.normalScale.value.copy(g.normalScale),g.side===ii&&m.normalScale.value.negate()),g.displacementMap&&(m.displacementMap.value=g.displacementMap,e(g.displacementMap,m.displacementMapTransform),m.displacementScale.value=g.displacementScale,m.displacementBias.value=g.displacementBias),g.emissiveMap&&(m.emissiveMap.value=g.emissiveMap,e(g.emissiveMap,m.emissiveMapTransform)),g.specularMap&&(m.specularMap.value=g.specularMap,e(g.specularMap,m.specularMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest);let v=t.get(g),T=v.envMap,S=v.envMapRotation;T&&(m.envMap.value=T,m.envMapRotation.value.setFromMatrix4(kA.makeRotationFromEuler(S)).transpose(),T.isCubeTexture&&T.isRenderTargetTexture===!1&&m.envMapRotation.value.premultiply(D0),m.reflectivity.value=g.reflectivity,m.ior.value=g.ior,m.refractionRatio.value=g.refractionRatio),g.lightMap&&(m.lightMap.value=g.lightMap,m.lightMapIntensity.value=g.lightMapIntensity,e(g.lightMap,m.lightMapTransform)),g.aoMap&&(m.aoMap.value=g.aoMap,m.aoMapIntensity.value=g.aoMapIntensity,e(g.aoMap,m.aoMapTransform))}function o(m,g){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,g.map&&(m.map.value=g.map,e(g.map,m.mapTransform))}function a(m,g){m.dashSize.value=g.dashSize,m.totalSize.value=g.dashSize+g.gapSize,m.scale.value=g.scale}function c(m,g,v,T){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,m.size.value=g.size*v,m.scale.value=T*.5,g.map&&(m.map.value=g.map,e(g.map,m.uvTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest)}function l(m,g){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,m.rotation.value=g.rotation,g.map&&(m.map.value=g.map,e(g.map,m.mapTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest)}function h(m,g){m.specular.value.copy(g.specular),m.shininess.value=Math.max(g.shininess,1e-4)}function f(m,g){g.gradientMap&&(m.gradientMap.value=g.gradientMap)}function u(m,g){m.metalness.value=g.metalness,g.metalnessMap&&(m.metalnessMap.value=g.metalnessMap,e(g.metalnessMap,m.metalnessMapTransform)),m.roughness.value=g.roughness,g.roughnessMap&&(m.roughnessMap.value=g.roughnessMap,e(g.roughnessMap,m.roughnessMapTransform)),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)}function d(m,g,v){m.ior.value=g.ior,g.diffuseRoughness>0&&(m.diffuseRoughness.value=g.diffuseRoughness,g.diffuseRoughnessMap&&(m.diffuseRoughnessMap.value=g.diffuseRoughnessMap,e(g.diffuseRoughnessMap,m.diffuseRoughnessMapTransform))),g.sheen>0&&(m.sheenColor.value.copy(g.sheenColor).multiplyScalar(g.sheen),m.sheenRoughness.value=g.sheenRoughness,g.sheenColorMap&&(m.sheenColorMap.value=g.sheenColorMap,e(g.sheenColorMap,m.sheenColorMapTransform)),g.sheenRoughnessMap&&(m.sheenRoughnessMap.value=g.sheenRoughnessMap,e(g.sheenRoughnessMap,m.sheenRoughnessMapTransform))),g.clearcoat>0&&(m.clearcoat.value=g.clearcoat,m.clearcoatRoughness.value=g.clearcoatRoughness,g.clearcoatMap&&(m.clearcoatMap.value=g.clearcoatMap,e(g.clearcoatMap,m.clearcoatMapTransform)),g.clearcoatRoughnessMap&&(m.clearcoatRoughnessMap.value=g.clearcoatRoughnessMap,e(g.clearcoatRoughnessMap,m.clearcoatRoughnessMapTransform)),g.clearcoatNormalMap&&(m.clearcoatNormalMap.value=g.clearcoatNormalMap,e(g.clearcoatNormalMap,m.clearcoatNormalMapTransform),m.clearcoatNormalScale.value.copy(g.clearcoatNormalScale),g.side===ii&&m.clearcoatNormalScale.value.negate())),g.dispersion>0&&(m.dispersion.value=g.dispersion),g.retroreflectivity>0&&(m.retroreflectivity.value=g.retroreflectivity),g.iridescence>0&&(m.iridescence.value=g.iridescence,m.iridescenceIOR.value=g.iridescenceIOR,m.iridescenceThicknessMinimum.value=g.iridescenceThicknessMinimum,m.iridescenceThicknessMaximum.value=g.iridescenceThicknessMaximum,g.iridescenceMap&&(m.iridescenceMap.value=g.iridescenceMap,e(g.iridescenceMap,m.iridescenceMapTransform)),g.iridescenceThicknessMap&&(m.iridescenceThicknessMap.value=g.iridescenceThicknessMap,e(g.iridescenceThicknessMap,m.iridescenceThicknessMapTransform))),g.transmission>0&&(m.transmission.value=g.transmission,m.transmissionSamplerMap.value=v.texture,m.transmissionSamplerSize.value.set(v.width,v.height),g.transmissionMap&&(m.transmissionMap.value=g.transmissionMap,e(g.transmissionMap,m.transmissionMapTransform)),m.thickness.value=g.thickness,g.thicknessMap&&(m.thicknessMap.value=g.thicknessMap,e(g.thicknessMap,m.thicknessMapTransform)),m.attenuationDistance.value=g.attenuationDistance,m.attenuationColor.value.copy(g.attenuationColor)),g.anisotropy>0&&(m.anisotropyVector.value.set(g.anisotropy*Math.cos(g.anisotropyRotation),g.anisotropy*Math.sin(g.anisotropyRotation)),g.anisotropyMap&&(m.anisotropyMap.value=g.anisotropyMap,e(g.anisotropyMap,m.anisotropyMapTransform))),m.specularIntensity.value=g.specularIntensity,m.specularColor.value.copy(g.specularColor),g.specularColorMap&&(m.specularColorMap.value=g.specularColorMap,e(g.specularColorMap,m.specularColorMapTransform)),g.specularIntensityMap&&(m.specularIntensityMap.value=g.specularIntensityMap,e(g.specularIntensityMap,m.specularIntensityMapTransform))}function p(m,g){g.matcap&&(m.matcap.value=g.matcap)}function _(m,g){let v=t.get(g).light;m.referencePosition.value.setFromMatrixPosition(v.matrixWorld),m.nearDistance.value=v.shadow.camera.near,m.farDistance.value=v.shadow.camera.far}return{refreshFogUniforms:i,refreshMaterialUniforms:s}}function HA(n,t,e,i){let s={},r={};function o(v,T){let S=T.program;i.uniformBlockBinding(v,S,s[v.id])}function a(v,T){let S=s[v.id];S===void 0&&(p(v),S=c(v),s[v.id]=S,v.addEventListener("dispose",m));let C=T.program;i.updateUBOMapping(v,C);let E=t.render.frame;r[v.id]!==E&&(l(v),r[v.id]=E)}function c(v){let T=n.createBuffer(),S=v.__size,C=v.usage;return n.bindBuffer(n.UNIFORM_BUFFER,T),n.bufferData(n.UNIFORM_BUFFER,S,C),n.bindBuffer(n.UNIFORM_BUFFER,null),T}function l(v){let T=s[v.id],S=v.uniforms,C=v.__cache;n.bindBuffer(n.UNIFORM_BUFFER,T);for(let E=0,y=S.length;E<y;E++){let w=S[E];if(Array.isArray(w))for(let V=0,N=w.length;V<N;V++)h(w[V],E,V,C);else h(w,E,0,C)}n.bindBuffer(n.UNIFORM_BUFFER,null)}function h(v,T,S,C){if(u(v,T,S,C)===!0){let E=v.__offset,y=v.value;if(Array.isArray(y)){let w=0;for(let V=0;V<y.length;V++){let N=y[V],L=_(N,!0);f(N,v.__data,w),w+=L.storage/Float32Array.BYTES_PER_ELEMENT}}else f(y,v.__data,0);n.bufferSubData(n.UNIFORM_BUFFER,E,v.__data)}}function f(v,T,S){typeof v=="number"||typeof v=="boolean"?T[S]=v:v.isMatrix3?(T[S]=v.elements[0],T[S+1]=v.elements[1],T[S+2]=v.elements[2],T[S+3]=0,T[S+4]=v.elements[3],T[S+5]=v.elements[4],T[S+6]=v.elements[5],T[S+7]=0,T[S+8]=v.elements[6],T[S+9]=v.elements[7],T[S+10]=v.elements[8],T[S+11]=0):ArrayBuffer.isView(v)?T.set(v.subarray(0,T.length-S),S):v.toArray(T,S)}function u(v,T,S,C){let E=v.value,y=T+"_"+S;if(Array.isArray(E)){C[y]===void 0&&(C[y]=[]);let w=C[y],V=!1;for(let N=0;N<E.length;N++)d(E[N],w,N)===!0&&(V=!0);return V}return d(E,C,y)}function d(v,T,S){if(T[S]===void 0)return typeof v=="number"||typeof v=="boolean"?T[S]=v:ArrayBuffer.isView(v)?T[S]=v.slice():T[S]=v.clone(),!0;{let C=T[S];if(typeof v=="number"||typeof v=="boolean"){if(C!==v)return T[S]=v,!0}else{if(ArrayBuffer.isView(v))return!0;if(C.equals(v)===!1)return C.copy(v),!0}}return!1}function p(v){let T=v.uniforms,S=0,C=16;for(let y=0,w=T.length;y<w;y++){let V=Array.isArray(T[y])?T[y]:[T[y]];for(let N=0,L=V.length;N<L;N++){let B=V[N],F=Array.isArray(B.value)?B.value:[B.value],R=Array.isArray(T[y])||Array.isArray(B.value),U=S;for(let G=0,ct=F.length;G<ct;G++){let I=F[G],k=_(I,R),Y=S%C,et=Y%k.boundary,nt=Y+et;S+=et,nt!==0&&C-nt<k.storage&&(S+=C-nt),G===0&&(U=S),S+=k.storage}let X=B.type==="int"?Int32Array:B.type==="uint"?Uint32Array:Float32Array;B.__data=new X((S-U)/Float32Array.BYTES_PER_ELEMENT),B.__offset=U}}let E=S%C;return E>0&&(S+=C-E),v.__size=S,v.__cache={},this}function _(v,T){let S={boundary:0,storage:0};return typeof v=="number"||typeof v=="boolean"?(S.boundary=4,S.storage=4):v.isVector2?(S.boundary=8,S.storage=8):v.isVector3||v.isColor?(S.boundary=16,S.storage=12):v.isVector4?(S.boundary=16,S.storage=16):v.isMatrix3?(S.boundary=16,S.storage=48):v.isMatrix4?(S.boundary=16,S.storage=64):v.isTexture?Kt("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(v)?(S.boundary=16,S.storage=v.byteLength):Kt("WebGLRenderer: Unsupported uniform value type.",v),T===!0&&(S.boundary=16,S.storage=Math.ceil(S.storage/16)*16),S}function m(v){let T=v.target;T.removeEventListener("dispose",m),n.deleteBuffer(s[T.id]),delete s[T.id],delete r[T.id]}function g(){for(let v in s)n.deleteBuffer(s[v]);s={},r={}}return{bind:o,update:a,dispose:g}}var VA=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),hs=null;function GA(){return hs===null&&(hs=new _o(VA,16,16,ar,$i),hs.name="DFG_LUT",hs.minFilter=Bn,hs.magFilter=Bn,hs.wrapS=as,hs.wrapT=as,hs.generateMipmaps=!1,hs.needsUpdate=!0),hs}var Oh=class{constructor(t={}){let{canvas:e=Xg(),context:i=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:c=!0,preserveDrawingBuffer:l=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:f=!1,reversedDepthBuffer:u=!1,outputBufferType:d=hi}=t;this.isWebGLRenderer=!0;let p;if(i!==null){if(typeof WebGLRenderingContext<"u"&&i instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");p=i.getContextAttributes().alpha}else p=o;let _=d,m=new Set([th,Qc,jc]),g=new Set([hi,Gi,Ao,Er,Kc,Jc]),v=new Uint32Array(4),T=new Int32Array(4),S={textures:[],min:[],max:[],resolution:[]},C=null,E=null,y=[],w=[],V=null;this.domElement=e,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=cs,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let N=this,L=!1,B=null,F=null,R=null,U=null;this._outputColorSpace=yi;let X=0,G=0,ct=null,I=-1,k=null,Y=new Je,et=new Je,nt=null,Z=new ue(0),at=0,ut=e.width,dt=e.height,ot=1,Lt=null,Zt=null,Ut=new Je(0,0,ut,dt),ne=new Je(0,0,ut,dt),ie=!1,$t=new Qs,Re=new Ac,be=!1,Ve=!1,we=new Be,cn=new $,Se=new Je,yn={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},en=!1;function hn(){return ct===null?ot:1}let H=i;function Rt(A,W){return e.getContext(A,W)}let Jt,le,Mt,ke,Gt,Yt,P,b,K,gt,ft,vt,St,st,lt,yt,z,ht,rt,Et,xt,wt,Wt;try{let A={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:c,preserveDrawingBuffer:l,powerPreference:h,failIfMajorPerformanceCaveat:f};if("setAttribute"in e&&e.setAttribute("data-engine",`three.js r${"187"}`),e.addEventListener("webglcontextlost",zt,!1),e.addEventListener("webglcontextrestored",ee,!1),e.addEventListener("webglcontextcreationerror",Ct,!1),H===null){let W="webgl2";if(H=Rt(W,A),H===null)throw Rt(W)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}te()}catch(A){throw e.removeEventListener("webglcontextlost",zt,!1),e.removeEventListener("webglcontextrestored",ee,!1),e.removeEventListener("webglcontextcreationerror",Ct,!1),re("WebGLRenderer: "+A.message),A}function te(){Jt=new tE(H),Jt.init(),xt=new UA(H,Jt),le=new GM(H,Jt,t,xt),Mt=new NA(H,Jt),le.reversedDepthBuffer&&u&&Mt.buffers.depth.setReversed(!0),F=H.createFramebuffer(),R=H.createFramebuffer(),U=H.createFramebuffer(),ke=new iE(H),Gt=new vA,Yt=new OA(H,Jt,Mt,Gt,le,xt,ke),P=new QM(N),b=new rb(H),wt=new HM(H,b),K=new eE(H,b,ke,wt),gt=new rE(H,K,b,wt,ke),ht=new sE(H,le,Yt),lt=new WM(Gt),ft=new xA(N,P,Jt,le,wt,lt),vt=new zA(N,Gt),St=new bA,st=new CA(Jt),z=new zM(N,P,Mt,gt,p,c),yt=new DA(N,gt,le),Wt=new HA(H,ke,le,Mt),rt=new VM(H,Jt,ke),Et=new nE(H,Jt,ke),ke.programs=ft.programs,N.capabilities=le,N.extensions=Jt,N.properties=Gt,N.renderLists=St,N.shadowMap=yt,N.state=Mt,N.info=ke}_!==hi&&(V=new aE(_,e.width,e.height,a,s,r));let mt=new Md(N,H);this.xr=mt,this.getContext=function(){return H},this.getContextAttributes=function(){return H.getContextAttributes()},this.forceContextLoss=function(){let A=Jt.get("WEBGL_lose_context");A&&A.loseContext()},this.forceContextRestore=function(){let A=Jt.get("WEBGL_lose_context");A&&A.restoreContext()},this.getPixelRatio=function(){return ot},this.setPixelRatio=function(A){A!==void 0&&(ot=A,this.setSize(ut,dt,!1))},this.getSize=function(A){return A.set(ut,dt)},this.setSize=function(A,W,it=!0){if(mt.isPresenting){Kt("WebGLRenderer: Can't change size while VR device is presenting.");return}ut=A,dt=W,e.width=Math.floor(A*ot),e.height=Math.floor(W*ot),it===!0&&(e.style.width=A+"px",e.style.height=W+"px"),V!==null&&V.setSize(e.width,e.height),this.setViewport(0,0,A,W)},this.getDrawingBufferSize=function(A){return A.set(ut*ot,dt*ot).floor()},this.setDrawingBufferSize=function(A,W,it){ut=A,dt=W,ot=it,e.width=Math.floor(A*it),e.height=Math.floor(W*it),this.setViewport(0,0,A,W)},this.setEffects=function(A){if(_===hi){re("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(A){for(let W=0;W<A.length;W++)if(A[W].isOutputPass===!0){Kt("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}V.setEffects(A||[])},this.getCurrentViewport=function(A){return A.copy(Y)},this.getViewport=function(A){return A.copy(Ut)},this.setViewport=function(A,W,it,j){A.isVector4?Ut.set(A.x,A.y,A.z,A.w):Ut.set(A,W,it,j),Mt.viewport(Y.copy(Ut).multiplyScalar(hn()).round())},this.getScissor=function(A){return A.copy(ne)},this.setScissor=function(A,W,it,j){A.isVector4?ne.set(A.x,A.y,A.z,A.w):ne.set(A,W,it,j),Mt.scissor(et.copy(ne).multiplyScalar(hn()).round())},this.getScissorTest=function(){return ie},this.setScissorTest=function(A){Mt.setScissorTest(ie=A)},this.setOpaqueSort=function(A){Lt=A},this.setTransparentSort=function(A){Zt=A},this.getClearColor=function(A){return A.copy(z.getClearColor())},this.setClearColor=function(){z.setClearColor(...arguments)},this.getClearAlpha=function(){return z.getClearAlpha()},this.setClearAlpha=function(){z.setClearAlpha(...arguments)},this.clear=function(A=!0,W=!0,it=!0){let j=0;if(A){let Q=!1;if(ct!==null){let At=ct.texture.format;Q=m.has(At)}if(Q){let At=ct.texture.type,It=g.has(At),Tt=z.getClearColor(),Pt=z.getClearAlpha(),Vt=Tt.r,se=Tt.g,de=Tt.b;It?(v[0]=Vt,v[1]=se,v[2]=de,v[3]=Pt,H.clearBufferuiv(H.COLOR,0,v)):(T[0]=Vt,T[1]=se,T[2]=de,T[3]=Pt,H.clearBufferiv(H.COLOR,0,T))}else j|=H.COLOR_BUFFER_BIT}W&&(j|=H.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),it&&(j|=H.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),j!==0&&H.clear(j)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(A){A.setRenderer(this),B=A},this.dispose=function(){e.removeEventListener("webglcontextlost",zt,!1),e.removeEventListener("webglcontextrestored",ee,!1),e.removeEventListener("webglcontextcreationerror",Ct,!1),z.dispose(),St.dispose(),st.dispose(),Yt.dispose(),Gt.dispose(),P.dispose(),gt.dispose(),K.dispose(),wt.dispose(),Wt.dispose(),ft.dispose(),mt.dispose(),mt.removeEventListener("sessionstart",ml),mt.removeEventListener("sessionend",Ji),ps.stop()};function zt(A){A.preventDefault(),od("WebGLRenderer: Context Lost."),L=!0}function ee(){od("WebGLRenderer: Context Restored."),L=!1;let A=ke.autoReset,W=yt.enabled,it=yt.autoUpdate,j=yt.needsUpdate,Q=yt.type;te(),ke.autoReset=A,yt.enabled=W,yt.autoUpdate=it,yt.needsUpdate=j,yt.type=Q}function Ct(A){re("WebGLRenderer: A WebGL context could not be created. Reason: ",A.statusMessage)}function ce(A){let W=A.target;W.removeEventListener("dispose",ce),Ge(W)}function Ge(A){Zn(A),Gt.remove(A)}function Zn(A){let W=Gt.get(A).programs;W!==void 0&&(W.forEach(function(it){ft.releaseProgram(it)}),A.isShaderMaterial&&ft.releaseShaderCache(A))}this.renderBufferDirect=function(A,W,it,j,Q,At){W===null&&(W=yn);let It=Q.isMesh&&Q.matrixWorld.determinantAffine()<0,Tt=Yo(A,W,it,j,Q);Mt.setMaterial(j,It);let Pt=it.index,Vt=1;if(j.wireframe===!0){if(Pt=K.getWireframeAttribute(it),Pt===void 0)return;Vt=2}let se=it.drawRange,de=it.attributes.position,Ht=se.start*Vt,pe=(se.start+se.count)*Vt;At!==null&&(Ht=Math.max(Ht,At.start*Vt),pe=Math.min(pe,(At.start+At.count)*Vt)),Pt!==null?(Ht=Math.max(Ht,0),pe=Math.min(pe,Pt.count)):de!=null&&(Ht=Math.max(Ht,0),pe=Math.min(pe,de.count));let je=pe-Ht;if(je<0||je===1/0)return;wt.setup(Q,j,Tt,it,Pt);let De,Ne=rt;if(Pt!==null&&(De=b.get(Pt),Ne=Et,Ne.setIndex(De)),Q.isMesh)j.wireframe===!0?(Mt.setLineWidth(j.wireframeLinewidth*hn()),Ne.setMode(H.LINES)):Ne.setMode(H.TRIANGLES);else if(Q.isLine){let xn=j.linewidth;xn===void 0&&(xn=1),Mt.setLineWidth(xn*hn()),Q.isLineSegments?Ne.setMode(H.LINES):Q.isLineLoop?Ne.setMode(H.LINE_LOOP):Ne.setMode(H.LINE_STRIP)}else Q.isPoints?Ne.setMode(H.POINTS):Q.isSprite&&Ne.setMode(H.TRIANGLES);if(Q.isBatchedMesh)if(Jt.get("WEBGL_multi_draw"))Ne.renderMultiDraw(Q._multiDrawStarts,Q._multiDrawCounts,Q._multiDrawCount);else{let xn=Q._multiDrawStarts,Ft=Q._multiDrawCounts,un=Q._multiDrawCount,_e=Pt?b.get(Pt).bytesPerElement:1,gs=Gt.get(j).currentProgram.getUniforms();for(let fn=0;fn<un;fn++)gs.setValue(H,"_gl_DrawID",fn),Ne.render(xn[fn]/_e,Ft[fn])}else if(Q.isInstancedMesh)Ne.renderInstances(Ht,je,Q.count);else if(it.isInstancedBufferGeometry){let xn=it._maxInstanceCount!==void 0?it._maxInstanceCount:1/0,Ft=Math.min(it.instanceCount,xn);Ne.renderInstances(Ht,je,Ft)}else Ne.render(Ht,je)};function $o(A,W,it,j){B!==null&&A.isNodeMaterial&&B.setObject(j,A),be===!0&&lt.setState(A,it,!1),A.transparent===!0&&A.side===si&&A.forceSinglePass===!1?(A.side=ii,A.needsUpdate=!0,ji(A,W,j),A.side=or,A.needsUpdate=!0,ji(A,W,j),A.side=si):ji(A,W,j)}this.compile=function(A,W,it=null){it===null&&(it=A),B!==null&&B.renderStart(A,W,it),E=st.get(it),E.init(W),w.push(E),it.traverseVisible(function(Q){Q.isLight&&Q.layers.test(W.layers)&&(E.pushLight(Q),Q.castShadow&&E.pushShadow(Q))}),A!==it&&A.traverseVisible(function(Q){Q.isLight&&Q.layers.test(W.layers)&&(E.pushLight(Q),Q.castShadow&&E.pushShadow(Q))}),E.setupLights(),B!==null&&B.updateLights(E.state.lightsArray),Ve=this.localClippingEnabled,be=lt.init(this.clippingPlanes,Ve),be===!0&&lt.setGlobalState(this.clippingPlanes,W),B!==null&&yt.render(E.state.shadowsArray,it,W);let j=new Set;return A.traverse(function(Q){if(!(Q.isMesh||Q.isPoints||Q.isLine||Q.isSprite))return;let At=Q.material;if(At)if(Array.isArray(At))for(let It=0;It<At.length;It++){let Tt=At[It];$o(Tt,it,W,Q),j.add(Tt)}else $o(At,it,W,Q),j.add(At)}),E=w.pop(),B!==null&&B.renderEnd(),j},this.compileAsync=function(A,W,it=null){let j=this.compile(A,W,it);return new Promise(Q=>{function At(){if(j.forEach(function(It){let Pt=Gt.get(It).currentProgram;(Pt===void 0||Pt.isReady())&&j.delete(It)}),j.size===0){Q(A);return}setTimeout(At,10)}Jt.get("KHR_parallel_shader_compile")!==null?At():setTimeout(At,10)})};let Dr=null;function Iu(A){Dr&&Dr(A)}function ml(){ps.stop()}function Ji(){ps.start()}let ps=new w0;ps.setAnimationLoop(Iu),typeof self<"u"&&ps.setContext(self),this.setAnimationLoop=function(A){Dr=A,mt.setAnimationLoop(A),A===null?ps.stop():ps.start()},mt.addEventListener("sessionstart",ml),mt.addEventListener("sessionend",Ji),this.render=function(A,W){if(W!==void 0&&W.isCamera!==!0){re("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(L===!0)return;B!==null&&B.renderStart(A,W);let it=mt.enabled===!0&&mt.isPresenting===!0,j=V!==null&&(ct===null||it)&&V.begin(N,ct);if(A.matrixWorldAutoUpdate===!0&&A.updateMatrixWorld(),W.parent===null&&W.matrixWorldAutoUpdate===!0&&W.updateMatrixWorld(),mt.enabled===!0&&mt.isPresenting===!0&&(V===null||V.isCompositing()===!1)&&(mt.cameraAutoUpdate===!0&&mt.updateCamera(W),W=mt.getCamera()),A.isScene===!0&&A.onBeforeRender(N,A,W,ct),E=st.get(A,w.length),E.init(W),E.state.textureUnits=Yt.getTextureUnits(),w.push(E),we.multiplyMatrices(W.projectionMatrix,W.matrixWorldInverse),W.isArrayCamera?Re.setFromArrayCamera(W):$t.setFromProjectionMatrix(we,Ii,W.reversedDepth),Ve=this.localClippingEnabled,be=lt.init(this.clippingPlanes,Ve),C=St.get(A,y.length),C.init(),y.push(C),this.info.render.frame++,mt.enabled===!0&&mt.isPresenting===!0){let It=N.xr.getDepthSensingMesh();It!==null&&ms(It,W,-1/0,N.sortObjects)}ms(A,W,0,N.sortObjects),C.finish(),B!==null&&B.updateLights(E.state.lightsArray),N.sortObjects===!0&&C.sort(Lt,Zt),en=mt.enabled===!1||mt.isPresenting===!1||mt.hasDepthSensing()===!1,en&&z.addToRenderList(C,A),this.info.autoReset===!0&&this.info.reset(),be===!0&&lt.beginShadows();let Q=E.state.shadowsArray;if(yt.render(Q,A,W),be===!0&&lt.endShadows(),(j&&V.hasRenderPass())===!1){let It=C.opaque,Tt=C.transmissive;if(E.setupLights(),W.isArrayCamera){let Pt=W.cameras;if(Tt.length>0)for(let Vt=0,se=Pt.length;Vt<se;Vt++){let de=Pt[Vt];Oi(It,Tt,A,de)}en&&z.render(A);for(let Vt=0,se=Pt.length;Vt<se;Vt++){let de=Pt[Vt];Xo(C,A,de,de.viewport)}}else Tt.length>0&&Oi(It,Tt,A,W),en&&z.render(A),Xo(C,A,W)}ct!==null&&G===0&&(Yt.updateMultisampleRenderTarget(ct),Yt.updateRenderTargetMipmap(ct)),j&&V.end(N),A.isScene===!0&&A.onAfterRender(N,A,W),wt.resetDefaultState(),I=-1,k=null,w.pop(),w.length>0?(E=w[w.length-1],Yt.setTextureUnits(E.state.textureUnits),be===!0&&lt.setGlobalState(N.clippingPlanes,E.state.camera)):E=null,y.pop(),y.length>0?C=y[y.length-1]:C=null,B!==null&&B.renderEnd()};function ms(A,W,it,j){if(A.visible===!1)return;if(A.layers.test(W.layers)){if(A.isGroup)it=A.renderOrder;else if(A.isLOD)A.autoUpdate===!0&&A.update(W);else if(A.isLight)E.pushLight(A),A.castShadow&&E.pushShadow(A);else if(A.isSprite){let It=W.isArrayCamera?Re:$t;if(!A.frustumCulled||A.intersectsFrustum(It)){j&&Se.setFromMatrixPosition(A.matrixWorld).applyMatrix4(we);let Tt=gt.update(A),Pt=A.material;Pt.visible&&C.push(A,Tt,Pt,it,Se.z,null,W)}}else if(A.isMesh||A.isLine||A.isPoints){let It=W.isArrayCamera?Re:$t;if(!A.frustumCulled||A.intersectsFrustum(It)){let Tt=gt.update(A),Pt=A.material;if(j&&(A.boundingSphere!==void 0?(A.boundingSphere===null&&A.computeBoundingSphere(),Se.copy(A.boundingSphere.center)):(Tt.boundingSphere===null&&Tt.computeBoundingSphere(),Se.copy(Tt.boundingSphere.center)),Se.applyMatrix4(A.matrixWorld).applyMatrix4(we)),Array.isArray(Pt)){let Vt=Tt.groups;for(let se=0,de=Vt.length;se<de;se++){let Ht=Vt[se],pe=Pt[Ht.materialIndex];pe&&pe.visible&&C.push(A,Tt,pe,it,Se.z,Ht,W)}}else Pt.visible&&C.push(A,Tt,Pt,it,Se.z,null,W)}}}let At=A.children;for(let It=0,Tt=At.length;It<Tt;It++)ms(At[It],W,it,j)}function Xo(A,W,it,j){let{opaque:Q,transmissive:At,transparent:It}=A;E.setupLightsView(it),be===!0&&lt.setGlobalState(N.clippingPlanes,it),j&&Mt.viewport(Y.copy(j)),Q.length>0&&nn(Q,W,it),At.length>0&&nn(At,W,it),It.length>0&&nn(It,W,it),Mt.buffers.depth.setTest(!0),Mt.buffers.depth.setMask(!0),Mt.buffers.color.setMask(!0),Mt.setPolygonOffset(!1)}function Oi(A,W,it,j){if((it.isScene===!0?it.overrideMaterial:null)!==null)return;if(E.state.transmissionRenderTarget[j.id]===void 0){let Ht=Jt.has("EXT_color_buffer_half_float")||Jt.has("EXT_color_buffer_float");E.state.transmissionRenderTarget[j.id]=new vi(1,1,{generateMipmaps:!0,type:Ht?$i:hi,minFilter:Is,samples:Math.max(4,le.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:ye.workingColorSpace})}let At=E.state.transmissionRenderTarget[j.id],It=j.viewport||Y;At.setSize(It.z*N.transmissionResolutionScale,It.w*N.transmissionResolutionScale);let Tt=N.getRenderTarget(),Pt=N.getActiveCubeFace(),Vt=N.getActiveMipmapLevel();N.setRenderTarget(At),N.getClearColor(Z),at=N.getClearAlpha(),at<1&&N.setClearColor(16777215,.5),N.clear(),en&&z.render(it);let se=N.toneMapping;N.toneMapping=cs;let de=j.viewport;if(j.viewport!==void 0&&(j.viewport=void 0),E.setupLightsView(j),be===!0&&lt.setGlobalState(N.clippingPlanes,j),nn(A,it,j),Yt.updateMultisampleRenderTarget(At),Yt.updateRenderTargetMipmap(At),Jt.has("WEBGL_multisampled_render_to_texture")===!1){let Ht=!1;for(let pe=0,je=W.length;pe<je;pe++){let De=W[pe],{object:Ne,geometry:xn,material:Ft,group:un}=De;if(Ft.side===si&&Ne.layers.test(j.layers)){let _e=Ft.side;Ft.side=ii,Ft.needsUpdate=!0,an(Ne,it,j,xn,Ft,un),Ft.side=_e,Ft.needsUpdate=!0,Ht=!0}}Ht===!0&&(Yt.updateMultisampleRenderTarget(At),Yt.updateRenderTargetMipmap(At))}N.setRenderTarget(Tt,Pt,Vt),N.setClearColor(Z,at),de!==void 0&&(j.viewport=de),N.toneMapping=se}function nn(A,W,it){let j=W.isScene===!0?W.overrideMaterial:null;for(let Q=0,At=A.length;Q<At;Q++){let It=A[Q],{object:Tt,geometry:Pt,group:Vt}=It,se=It.material;se.allowOverride===!0&&j!==null&&(se=j),Tt.layers.test(it.layers)&&an(Tt,W,it,Pt,se,Vt)}}function an(A,W,it,j,Q,At){B!==null&&Q.isNodeMaterial&&B.setObject(A,Q),A.onBeforeRender(N,W,it,j,Q,At),A.modelViewMatrix.multiplyMatrices(it.matrixWorldInverse,A.matrixWorld),A.normalMatrix.getNormalMatrix(A.modelViewMatrix),Q.onBeforeRender(N,W,it,j,A,At),Q.transparent===!0&&Q.side===si&&Q.forceSinglePass===!1?(Q.side=ii,Q.needsUpdate=!0,N.renderBufferDirect(it,W,j,Q,A,At),Q.side=or,Q.needsUpdate=!0,N.renderBufferDirect(it,W,j,Q,A,At),Q.side=si):N.renderBufferDirect(it,W,j,Q,A,At),A.onAfterRender(N,W,it,j,Q,At)}function ln(A){let W=0;for(let it of A)it.texture!==null&&W++;return W}function ji(A,W,it){W.isScene!==!0&&(W=yn);let j=Gt.get(A),Q=E.state.lights,At=E.state.shadowsArray,It=Q.state.version,Tt=ft.getParameters(A,Q.state,At,W,it,E.state.lightProbeGridArray),Pt=ft.getProgramCacheKey(Tt),Vt=j.programs;j.environment=A.isMeshStandardMaterial||A.isMeshLambertMaterial||A.isMeshPhongMaterial?W.environment:null,j.fog=W.fog;let se=A.isMeshStandardMaterial||A.isMeshLambertMaterial&&!A.envMap||A.isMeshPhongMaterial&&!A.envMap;j.envMap=P.get(A.envMap||j.environment,se),j.envMapRotation=j.environment!==null&&A.envMap===null?W.environmentRotation:A.envMapRotation,Vt===void 0&&(A.addEventListener("dispose",ce),Vt=new Map,j.programs=Vt,j.programVariants=new Map);let de=Vt.get(Pt);if(de!==void 0){if(j.currentProgram===de&&j.lightsStateVersion===It)return qo(A,Tt),de}else Tt.uniforms=ft.getUniforms(A),B!==null&&A.isNodeMaterial&&B.build(A,it,Tt),A.onBeforeCompile(Tt,N),de=ft.acquireProgram(Tt,Pt),Vt.set(Pt,de),j.uniforms=Tt.uniforms;let Ht=j.uniforms;return(!A.isShaderMaterial&&!A.isRawShaderMaterial||A.clipping===!0)&&(Ht.clippingPlanes=lt.uniform),qo(A,Tt),j.needsLights=Fs(A),j.lightsStateVersion=It,j.needsLights&&(Ht.ambientLightColor.value=Q.state.ambient,Ht.lightProbe.value=Q.state.probe,Ht.sunLights.value=Q.state.sun,Ht.sunLightShadows.value=Q.state.sunShadow,Ht.directionalLights.value=Q.state.directional,Ht.directionalLightShadows.value=Q.state.directionalShadow,Ht.spotLights.value=Q.state.spot,Ht.spotLightShadows.value=Q.state.spotShadow,Ht.rectAreaLights.value=Q.state.rectArea,Ht.ltc_1.value=Q.state.rectAreaLTC1,Ht.ltc_2.value=Q.state.rectAreaLTC2,Ht.pointLights.value=Q.state.point,Ht.pointLightShadows.value=Q.state.pointShadow,Ht.hemisphereLights.value=Q.state.hemi,Ht.sunShadowMatrix.value=Q.state.sunShadowMatrix,Ht.sunShadowCascade.value=Q.state.sunShadowCascade,Ht.directionalShadowMatrix.value=Q.state.directionalShadowMatrix,Ht.spotLightMatrix.value=Q.state.spotLightMatrix,Ht.spotLightMap.value=Q.state.spotLightMap,Ht.pointShadowMatrix.value=Q.state.pointShadowMatrix),j.numLightProbeGrids=ln(E.state.lightProbeGridArray),j.currentProgram=de,j.uniformsList=null,de}function fi(A,W,it,j,Q){let At=Gt.get(A),It=At.currentProgram.id+","+j+","+Q,Tt=At.programVariants.get(It);return Tt===void 0?(Tt=ji(A,W,it),At.programVariants.set(It,Tt)):(At.currentProgram=Tt,At.uniformsList=null,At.outputColorSpace=j,At.toneMapping=Q),Tt}function Us(A){if(A.uniformsList===null){let W=A.currentProgram.getUniforms();A.uniformsList=Co.seqWithValue(W.seq,A.uniforms)}return A.uniformsList}function qo(A,W){let it=Gt.get(A);it.outputColorSpace=W.outputColorSpace,it.batching=W.batching,it.batchingColor=W.batchingColor,it.instancing=W.instancing,it.instancingColor=W.instancingColor,it.instancingMorph=W.instancingMorph,it.skinning=W.skinning,it.morphTargets=W.morphTargets,it.morphNormals=W.morphNormals,it.morphColors=W.morphColors,it.morphTargetsCount=W.morphTargetsCount,it.numClippingPlanes=W.numClippingPlanes,it.numIntersection=W.numClipIntersection,it.vertexAlphas=W.vertexAlphas,it.vertexTangents=W.vertexTangents,it.toneMapping=W.toneMapping}function Yo(A,W,it,j,Q){W.isScene!==!0&&(W=yn),Yt.resetTextureUnits();let At=W.fog,It=j.isMeshStandardMaterial||j.isMeshLambertMaterial||j.isMeshPhongMaterial?W.environment:null,Tt=ct===null?N.outputColorSpace:ct.isXRRenderTarget===!0?ct.texture.colorSpace:ye.workingColorSpace,Pt=j.isMeshStandardMaterial||j.isMeshLambertMaterial&&!j.envMap||j.isMeshPhongMaterial&&!j.envMap,Vt=P.get(j.envMap||It,Pt),se=j.vertexColors===!0&&!!it.attributes.color&&it.attributes.color.itemSize===4,de=!!it.attributes.tangent&&(!!j.normalMap||j.anisotropy>0),Ht=!!it.morphAttributes.position,pe=!!it.morphAttributes.normal,je=!!it.morphAttributes.color,De=cs;j.toneMapped&&(ct===null||ct.isXRRenderTarget===!0)&&(De=N.toneMapping);let Ne=it.morphAttributes.position||it.morphAttributes.normal||it.morphAttributes.color,xn=Ne!==void 0?Ne.length:0,Ft=Gt.get(j),un=E.state.lights;if(be===!0&&(Ve===!0||A!==k)){let Oe=A===k&&j.id===I;lt.setState(j,A,Oe)}let _e=!1,gs=!1;j.version===Ft.__version?Ft.needsLights&&Ft.lightsStateVersion!==un.state.version||Q.isBatchedMesh&&Ft.batching===!1||!Q.isBatchedMesh&&Ft.batching===!0||Q.isBatchedMesh&&Ft.batchingColor===!0&&Q._colorsTexture===null||Q.isBatchedMesh&&Ft.batchingColor===!1&&Q._colorsTexture!==null||Q.isInstancedMesh&&Ft.instancing===!1||!Q.isInstancedMesh&&Ft.instancing===!0||Q.isSkinnedMesh&&Ft.skinning===!1||!Q.isSkinnedMesh&&Ft.skinning===!0||Q.isInstancedMesh&&Ft.instancingColor===!0&&Q.instanceColor===null||Q.isInstancedMesh&&Ft.instancingColor===!1&&Q.instanceColor!==null||Q.isInstancedMesh&&Ft.instancingMorph===!0&&Q.morphTexture===null||Q.isInstancedMesh&&Ft.instancingMorph===!1&&Q.morphTexture!==null||Ft.envMap!==Vt||j.fog===!0&&Ft.fog!==At||Ft.numClippingPlanes!==void 0&&(Ft.numClippingPlanes!==lt.numPlanes||Ft.numIntersection!==lt.numIntersection)||Ft.vertexAlphas!==se||Ft.vertexTangents!==de||Ft.morphTargets!==Ht||Ft.morphNormals!==pe||Ft.morphColors!==je||Ft.morphTargetsCount!==xn||Ft.numLightProbeGrids!==ln(E.state.lightProbeGridArray)?_e=!0:(Ft.outputColorSpace!==Tt||Ft.toneMapping!==De)&&(gs=!0):(_e=!0,Ft.__version=j.version);let fn=Ft.currentProgram;(_e===!0||gs===!0)&&(fn=gs===!0?fi(j,W,Q,Tt,De):ji(j,W,Q),B&&j.isNodeMaterial&&B.onUpdateProgram(j,fn,Ft));let Ur=!1,Qi=!1,_s=!1,he=fn.getUniforms(),sn=Ft.uniforms;if(Mt.useProgram(fn.program)&&(Ur=!0,Qi=!0,_s=!0),j.id!==I&&(I=j.id,Qi=!0),Ur||k!==A){Mt.buffers.depth.getReversed()&&A.reversedDepth!==!0&&(A._reversedDepth=!0,A.updateProjectionMatrix()),he.setValue(H,"projectionMatrix",A.projectionMatrix),he.setValue(H,"viewMatrix",A.matrixWorldInverse);let dn=he.map.cameraPosition;dn!==void 0&&dn.setValue(H,cn.setFromMatrixPosition(A.matrixWorld)),le.logarithmicDepthBuffer&&he.setValue(H,"logDepthBufFC",2/(Math.log(A.far+1)/Math.LN2)),(j.isMeshPhongMaterial||j.isMeshToonMaterial||j.isMeshLambertMaterial||j.isMeshBasicMaterial||j.isMeshStandardMaterial||j.isShaderMaterial)&&he.setValue(H,"isOrthographic",A.isOrthographicCamera===!0),k!==A&&(k=A,Qi=!0,_s=!0)}if(Ft.needsLights&&(un.state.sunShadowMap.length>0&&he.setValue(H,"sunShadowMap",un.state.sunShadowMap,Yt),un.state.directionalShadowMap.length>0&&he.setValue(H,"directionalShadowMap",un.state.directionalShadowMap,Yt),un.state.spotShadowMap.length>0&&he.setValue(H,"spotShadowMap",un.state.spotShadowMap,Yt),un.state.pointShadowMap.length>0&&he.setValue(H,"pointShadowMap",un.state.pointShadowMap,Yt)),Q.isSkinnedMesh){he.setOptional(H,Q,"bindMatrix"),he.setOptional(H,Q,"bindMatrixInverse");let Oe=Q.skeleton;Oe&&(Oe.boneTexture===null&&Oe.computeBoneTexture(),he.setValue(H,"boneTexture",Oe.boneTexture,Yt))}Q.isBatchedMesh&&(he.setOptional(H,Q,"batchingTexture"),he.setValue(H,"batchingTexture",Q._matricesTexture,Yt),he.setOptional(H,Q,"batchingIdTexture"),he.setValue(H,"batchingIdTexture",Q._indirectTexture,Yt),he.setOptional(H,Q,"batchingColorTexture"),Q._colorsTexture!==null&&he.setValue(H,"batchingColorTexture",Q._colorsTexture,Yt));let Kn=it.morphAttributes;if((Kn.position!==void 0||Kn.normal!==void 0||Kn.color!==void 0)&&ht.update(Q,it,fn),(Qi||Ft.receiveShadow!==Q.receiveShadow)&&(Ft.receiveShadow=Q.receiveShadow,he.setValue(H,"receiveShadow",Q.receiveShadow)),(j.isMeshStandardMaterial||j.isMeshLambertMaterial||j.isMeshPhongMaterial)&&j.envMap===null&&W.environment!==null&&(sn.envMapIntensity.value=W.environmentIntensity),sn.dfgLUT!==void 0&&(sn.dfgLUT.value=GA()),Qi){if(he.setValue(H,"toneMappingExposure",N.toneMappingExposure),Ft.needsLights&&Nr(sn,_s),At&&j.fog===!0&&vt.refreshFogUniforms(sn,At),vt.refreshMaterialUniforms(sn,j,ot,dt,E.state.transmissionRenderTarget[A.id]),Ft.needsLights&&Ft.numLightProbeGrids>0){let Oe=S,dn=0;for(let Vn of E.state.lightProbeGridArray)Vn.texture!==null&&(Oe.textures[dn]=Vn.texture,Oe.min[dn]=Vn.boundingBox.min,Oe.max[dn]=Vn.boundingBox.max,Oe.resolution[dn]=Vn.resolution,dn++);for(let Vn in Oe)Oe[Vn].length=dn;sn.probesSH.value=Oe.textures,sn.probesMin.value=Oe.min,sn.probesMax.value=Oe.max,sn.probesResolution.value=Oe.resolution}Co.upload(H,Us(Ft),sn,Yt)}if(j.isShaderMaterial&&j.uniformsNeedUpdate===!0&&(Co.upload(H,Us(Ft),sn,Yt),j.uniformsNeedUpdate=!1),j.isSpriteMaterial&&he.setValue(H,"center",Q.center),he.setValue(H,"modelViewMatrix",Q.modelViewMatrix),he.setValue(H,"normalMatrix",Q.normalMatrix),he.setValue(H,"modelMatrix",Q.matrixWorld),j.uniformsGroups!==void 0){let Oe=j.uniformsGroups;for(let dn=0,Vn=Oe.length;dn<Vn;dn++){let gl=Oe[dn];Wt.update(gl,fn),Wt.bind(gl,fn)}}return fn}function Nr(A,W){A.ambientLightColor.needsUpdate=W,A.lightProbe.needsUpdate=W,A.sunLights.needsUpdate=W,A.sunLightShadows.needsUpdate=W,A.directionalLights.needsUpdate=W,A.directionalLightShadows.needsUpdate=W,A.pointLights.needsUpdate=W,A.pointLightShadows.needsUpdate=W,A.spotLights.needsUpdate=W,A.spotLightShadows.needsUpdate=W,A.rectAreaLights.needsUpdate=W,A.hemisphereLights.needsUpdate=W}function Fs(A){return A.isMeshLambertMaterial||A.isMeshToonMaterial||A.isMeshPhongMaterial||A.isMeshStandardMaterial||A.isShadowMaterial||A.isShaderMaterial&&A.lights===!0}this.getActiveCubeFace=function(){return X},this.getActiveMipmapLevel=function(){return G},this.getRenderTarget=function(){return ct},this.setRenderTargetTextures=function(A,W,it){let j=Gt.get(A);j.__autoAllocateDepthBuffer=A.resolveDepthBuffer===!1,j.__autoAllocateDepthBuffer===!1&&(j.__useRenderToTexture=!1),Gt.get(A.texture).__webglTexture=W,Gt.get(A.depthTexture).__webglTexture=j.__autoAllocateDepthBuffer?void 0:it,j.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(A,W){let it=Gt.get(A);it.__webglFramebuffer=W,it.__useDefaultFramebuffer=W===void 0},this.setRenderTarget=function(A,W=0,it=0){ct=A,X=W,G=it;let j=null,Q=!1,At=!1;if(A){let Tt=Gt.get(A);if(Tt.__useDefaultFramebuffer!==void 0){Mt.bindFramebuffer(H.FRAMEBUFFER,Tt.__webglFramebuffer),Y.copy(A.viewport),et.copy(A.scissor),nt=A.scissorTest,Mt.viewport(Y),Mt.scissor(et),Mt.setScissorTest(nt),I=-1;return}else if(Tt.__webglFramebuffer===void 0)Yt.setupRenderTarget(A);else if(Tt.__hasExternalTextures)Yt.rebindTextures(A,Gt.get(A.texture).__webglTexture,Gt.get(A.depthTexture).__webglTexture);else if(A.depthBuffer){let se=A.depthTexture;if(Tt.__boundDepthTexture!==se){if(se!==null&&Gt.has(se)&&(A.width!==se.image.width||A.height!==se.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");Yt.setupDepthRenderbuffer(A)}}let Pt=A.texture;(Pt.isData3DTexture||Pt.isDataArrayTexture||Pt.isCompressedArrayTexture)&&(At=!0);let Vt=Gt.get(A).__webglFramebuffer;A.isWebGLCubeRenderTarget?(Array.isArray(Vt[W])?j=Vt[W][it]:j=Vt[W],Q=!0):A.samples>0&&Yt.useMultisampledRTT(A)===!1?j=Gt.get(A).__webglMultisampledFramebuffer:Array.isArray(Vt)?j=Vt[it]:j=Vt,Y.copy(A.viewport),et.copy(A.scissor),nt=A.scissorTest}else Y.copy(Ut).multiplyScalar(ot).floor(),et.copy(ne).multiplyScalar(ot).floor(),nt=ie;if(it!==0&&(j=F),Mt.bindFramebuffer(H.FRAMEBUFFER,j)&&Mt.drawBuffers(A,j),Mt.viewport(Y),Mt.scissor(et),Mt.setScissorTest(nt),Q){let Tt=Gt.get(A.texture);H.framebufferTexture2D(H.FRAMEBUFFER,H.COLOR_ATTACHMENT0,H.TEXTURE_CUBE_MAP_POSITIVE_X+W,Tt.__webglTexture,it)}else if(At){let Tt=W;for(let Pt=0;Pt<A.textures.length;Pt++){let Vt=Gt.get(A.textures[Pt]);H.framebufferTextureLayer(H.FRAMEBUFFER,H.COLOR_ATTACHMENT0+Pt,Vt.__webglTexture,it,Tt)}}else if(A!==null&&it!==0){let Tt=Gt.get(A.texture);H.framebufferTexture2D(H.FRAMEBUFFER,H.COLOR_ATTACHMENT0,H.TEXTURE_2D,Tt.__webglTexture,it)}I=-1};function Or(A){let W=Gt.get(A);return(W.__readFormat!==A.format||W.__readType!==A.type)&&(W.__readFormat=A.format,W.__readType=A.type,W.__formatReadable=le.textureFormatReadable(A.format),W.__typeReadable=le.textureTypeReadable(A.type)),W}this.readRenderTargetPixels=function(A,W,it,j,Q,At,It,Tt=0){if(!(A&&A.isWebGLRenderTarget)){re("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let Pt=Gt.get(A).__webglFramebuffer;if(A.isWebGLCubeRenderTarget&&It!==void 0&&(Pt=Pt[It],Array.isArray(Pt)&&(Pt=Pt[0])),Pt){Mt.bindFramebuffer(H.FRAMEBUFFER,Pt);try{let Vt=A.textures[Tt],se=Vt.format,de=Vt.type;A.textures.length>1&&H.readBuffer(H.COLOR_ATTACHMENT0+Tt);let Ht=Or(Vt);if(Ht.__formatReadable===!1){re("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(Ht.__typeReadable===!1){re("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}W>=0&&W<=A.width-j&&it>=0&&it<=A.height-Q&&H.readPixels(W,it,j,Q,xt.convert(se),xt.convert(de),At)}finally{let Vt=ct!==null?Gt.get(ct).__webglFramebuffer:null;Mt.bindFramebuffer(H.FRAMEBUFFER,Vt)}}},this.readRenderTargetPixelsAsync=async function(A,W,it,j,Q,At,It,Tt=0){if(!(A&&A.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let Pt=Gt.get(A).__webglFramebuffer;if(A.isWebGLCubeRenderTarget&&It!==void 0&&(Pt=Pt[It],Array.isArray(Pt)&&(Pt=Pt[0])),Pt)if(W>=0&&W<=A.width-j&&it>=0&&it<=A.height-Q){Mt.bindFramebuffer(H.FRAMEBUFFER,Pt);let Vt=A.textures[Tt],se=Vt.format,de=Vt.type;A.textures.length>1&&H.readBuffer(H.COLOR_ATTACHMENT0+Tt);let Ht=Or(Vt);if(Ht.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(Ht.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");let pe=H.createBuffer();H.bindBuffer(H.PIXEL_PACK_BUFFER,pe),H.bufferData(H.PIXEL_PACK_BUFFER,At.byteLength,H.STREAM_READ),H.readPixels(W,it,j,Q,xt.convert(se),xt.convert(de),0),H.bindBuffer(H.PIXEL_PACK_BUFFER,null);let je=ct!==null?Gt.get(ct).__webglFramebuffer:null;Mt.bindFramebuffer(H.FRAMEBUFFER,je);let De=H.fenceSync(H.SYNC_GPU_COMMANDS_COMPLETE,0);return H.flush(),await Yg(H,De,4),H.bindBuffer(H.PIXEL_PACK_BUFFER,pe),H.getBufferSubData(H.PIXEL_PACK_BUFFER,0,At),H.bindBuffer(H.PIXEL_PACK_BUFFER,null),H.deleteBuffer(pe),H.deleteSync(De),At}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(A,W=null,it=0){let j=Math.pow(2,-it),Q=Math.floor(A.image.width*j),At=Math.floor(A.image.height*j),It=W!==null?W.x:0,Tt=W!==null?W.y:0;Yt.setTexture2D(A,0),H.copyTexSubImage2D(H.TEXTURE_2D,it,0,0,It,Tt,Q,At),Mt.unbindTexture()},this.copyTextureToTexture=function(A,W,it=null,j=null,Q=0,At=0){let It,Tt,Pt,Vt,se,de,Ht,pe,je,De=A.isCompressedTexture?A.mipmaps[At]:A.image;if(it!==null)It=it.max.x-it.min.x,Tt=it.max.y-it.min.y,Pt=it.isBox3?it.max.z-it.min.z:1,Vt=it.min.x,se=it.min.y,de=it.isBox3?it.min.z:0;else{let he=Math.pow(2,-Q);It=Math.floor(De.width*he),Tt=Math.floor(De.height*he),A.isDataArrayTexture?Pt=De.depth:A.isData3DTexture?Pt=Math.floor(De.depth*he):Pt=1,Vt=0,se=0,de=0}j!==null?(Ht=j.x,pe=j.y,je=j.z):(Ht=0,pe=0,je=0);let Ne=xt.convert(W.format),xn=xt.convert(W.type),Ft;W.isData3DTexture?(Yt.setTexture3D(W,0),Ft=H.TEXTURE_3D):W.isDataArrayTexture||W.isCompressedArrayTexture?(Yt.setTexture2DArray(W,0),Ft=H.TEXTURE_2D_ARRAY):(Yt.setTexture2D(W,0),Ft=H.TEXTURE_2D),Mt.activeTexture(H.TEXTURE0),Mt.pixelStorei(H.UNPACK_FLIP_Y_WEBGL,W.flipY),Mt.pixelStorei(H.UNPACK_PREMULTIPLY_ALPHA_WEBGL,W.premultiplyAlpha),Mt.pixelStorei(H.UNPACK_ALIGNMENT,W.unpackAlignment);let un=Mt.getParameter(H.UNPACK_ROW_LENGTH),_e=Mt.getParameter(H.UNPACK_IMAGE_HEIGHT),gs=Mt.getParameter(H.UNPACK_SKIP_PIXELS),fn=Mt.getParameter(H.UNPACK_SKIP_ROWS),Ur=Mt.getParameter(H.UNPACK_SKIP_IMAGES);Mt.pixelStorei(H.UNPACK_ROW_LENGTH,De.width),Mt.pixelStorei(H.UNPACK_IMAGE_HEIGHT,De.height),Mt.pixelStorei(H.UNPACK_SKIP_PIXELS,Vt),Mt.pixelStorei(H.UNPACK_SKIP_ROWS,se),Mt.pixelStorei(H.UNPACK_SKIP_IMAGES,de);let Qi=A.isDataArrayTexture||A.isData3DTexture,_s=W.isDataArrayTexture||W.isData3DTexture;if(A.isDepthTexture){let he=Gt.get(A),sn=Gt.get(W),Kn=Gt.get(he.__renderTarget),Oe=Gt.get(sn.__renderTarget);Mt.bindFramebuffer(H.READ_FRAMEBUFFER,Kn.__webglFramebuffer),Mt.bindFramebuffer(H.DRAW_FRAMEBUFFER,Oe.__webglFramebuffer);for(let dn=0;dn<Pt;dn++)Qi&&(H.framebufferTextureLayer(H.READ_FRAMEBUFFER,H.COLOR_ATTACHMENT0,Gt.get(A).__webglTexture,Q,de+dn),H.framebufferTextureLayer(H.DRAW_FRAMEBUFFER,H.COLOR_ATTACHMENT0,Gt.get(W).__webglTexture,At,je+dn)),H.blitFramebuffer(Vt,se,Vt+It,se+Tt,Ht,pe,Ht+It,pe+Tt,H.DEPTH_BUFFER_BIT,H.NEAREST);Mt.bindFramebuffer(H.READ_FRAMEBUFFER,null),Mt.bindFramebuffer(H.DRAW_FRAMEBUFFER,null)}else if(Q!==0||A.isRenderTargetTexture||Gt.has(A)){let he=Gt.get(A),sn=Gt.get(W);Mt.bindFramebuffer(H.READ_FRAMEBUFFER,R),Mt.bindFramebuffer(H.DRAW_FRAMEBUFFER,U);for(let Kn=0;Kn<Pt;Kn++)Qi?H.framebufferTextureLayer(H.READ_FRAMEBUFFER,H.COLOR_ATTACHMENT0,he.__webglTexture,Q,de+Kn):H.framebufferTexture2D(H.READ_FRAMEBUFFER,H.COLOR_ATTACHMENT0,H.TEXTURE_2D,he.__webglTexture,Q),_s?H.framebufferTextureLayer(H.DRAW_FRAMEBUFFER,H.COLOR_ATTACHMENT0,sn.__webglTexture,At,je+Kn):H.framebufferTexture2D(H.DRAW_FRAMEBUFFER,H.COLOR_ATTACHMENT0,H.TEXTURE_2D,sn.__webglTexture,At),Q!==0?H.blitFramebuffer(Vt,se,Vt+It,se+Tt,Ht,pe,Ht+It,pe+Tt,H.COLOR_BUFFER_BIT,H.NEAREST):_s?H.copyTexSubImage3D(Ft,At,Ht,pe,je+Kn,Vt,se,It,Tt):H.copyTexSubImage2D(Ft,At,Ht,pe,Vt,se,It,Tt);Mt.bindFramebuffer(H.READ_FRAMEBUFFER,null),Mt.bindFramebuffer(H.DRAW_FRAMEBUFFER,null)}else _s?A.isDataTexture||A.isData3DTexture?H.texSubImage3D(Ft,At,Ht,pe,je,It,Tt,Pt,Ne,xn,De.data):W.isCompressedArrayTexture?H.compressedTexSubImage3D(Ft,At,Ht,pe,je,It,Tt,Pt,Ne,De.data):H.texSubImage3D(Ft,At,Ht,pe,je,It,Tt,Pt,Ne,xn,De):A.isDataTexture?H.texSubImage2D(H.TEXTURE_2D,At,Ht,pe,It,Tt,Ne,xn,De.data):A.isCompressedTexture?H.compressedTexSubImage2D(H.TEXTURE_2D,At,Ht,pe,De.width,De.height,Ne,De.data):H.texSubImage2D(H.TEXTURE_2D,At,Ht,pe,It,Tt,Ne,xn,De);Mt.pixelStorei(H.UNPACK_ROW_LENGTH,un),Mt.pixelStorei(H.UNPACK_IMAGE_HEIGHT,_e),Mt.pixelStorei(H.UNPACK_SKIP_PIXELS,gs),Mt.pixelStorei(H.UNPACK_SKIP_ROWS,fn),Mt.pixelStorei(H.UNPACK_SKIP_IMAGES,Ur),At===0&&W.generateMipmaps===!0&&W.mipmapsAutoUpdate===!0&&H.generateMipmap(Ft),Mt.unbindTexture()},this.initRenderTarget=function(A){Gt.get(A).__webglFramebuffer===void 0&&Yt.setupRenderTarget(A)},this.initTexture=function(A){A.isCubeTexture?Yt.setTextureCube(A,0):A.isData3DTexture?Yt.setTexture3D(A,0):A.isDataArrayTexture||A.isCompressedArrayTexture?Yt.setTexture2DArray(A,0):Yt.setTexture2D(A,0),Mt.unbindTexture()},this.resetState=function(){X=0,G=0,ct=null,Mt.reset(),wt.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return Ii}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(t){this._outputColorSpace=t;let e=this.getContext();e.drawingBufferColorSpace=ye._getDrawingBufferColorSpace(t),e.unpackColorSpace=ye._getUnpackColorSpace()}};var N0=new $(0,0,1),WA=new So(.9,1.05,64),$A=new So(.94,1.01,64),XA=new vo(.025,.025,.8,10).translate(0,.4,0).rotateX(Math.PI/2),qA=new Oa(.075,.2,14).translate(0,.9,0).rotateX(Math.PI/2),YA=new Na(.16,24),ZA=.93,KA=14964526,JA=.45,O0=.08,Bh=class{constructor(){this.group=new ei,this.markers=[],this.greatest=0}show(t,e){for(;this.markers.length<t.length;)this.add();this.greatest=Math.max(this.greatest,...t.map(U0)),this.markers.forEach((i,s)=>{i.group.visible=s<t.length,i.group.visible&&this.place(i,t[s],e)})}reset(){this.greatest=0,this.show([],1)}face(t){for(let{group:e,arrow:i,dot:s,materials:r,normal:o}of this.markers){let a=o.dot(t.position.clone().sub(e.position).normalize());for(let c of r)c.opacity=a<0?.25:1;s.visible=Math.abs(a)>ZA,i.visible=!s.visible}}add(){let t=a=>new go({color:a,side:si,transparent:!0,depthTest:!1,depthWrite:!1}),e=[t(1053980),t(16777215),t(KA)],i=il(YA,e[2],12),s=new ei().add(il(WA,e[0],10),il($A,e[1],11),i),r=new ei().add(il(XA,e[2],12),il(qA,e[2],12)),o=new ei().add(s,r);this.markers.push({group:o,ring:s,arrow:r,dot:i,materials:e,normal:new $(0,0,1)}),this.group.add(o)}place(t,e,i){let{group:s,ring:r,arrow:o,normal:a}=t;s.position.copy(e.position),a.copy(e.normal),a.lengthSq()>.01||a.copy(N0),s.quaternion.copy(new kn().setFromUnitVectors(N0,a.normalize())),r.scale.setScalar(Ed(e,i));let c=this.greatest>0?U0(e)/this.greatest:0;o.scale.setScalar(i*(O0+(JA-O0)*c))}};function Ed(n,t){let e=Math.sqrt(n.area/Math.PI);return Number.isFinite(e)&&e>0?Math.max(e,t*.02):t*.05}function U0(n){let t=Number.isFinite(n.force)?n.force:n.strength;return Number.isFinite(t)?Math.max(0,t):0}function il(n,t,e){let i=new ni(n,t);return i.renderOrder=e,i}var zh=22,jA=6,kh=4,QA={circle:()=>li("circle",{r:9}),square:()=>li("rect",{x:-9,y:-9,width:18,height:18}),diamond:()=>li("path",{d:"M0,-13 L13,0 L0,13 L-13,0 Z"}),triangle:()=>li("path",{d:"M0,-14 L13,9 L-13,9 Z"})},Hh=class{constructor(t,e){this.scene=e,this.contactLayer=qt("div"),this.electrodeLayer=li("svg"),t.append(this.electrodeLayer,this.contactLayer),this.contacts=[],this.electrodes=[],this.outward=[]}setElectrodes(t,e){let i=t.length/3;this.electrodes=Array.from({length:i},(s,r)=>new $().fromArray(t,3*r)),this.outward=this.electrodes.map(s=>t1(s,e)),this.electrodeLayer.replaceChildren(),this.states=""}showElectrodes(t){let e=JSON.stringify(t.map(({state:i,colour:s})=>[i,s]));e!==this.states&&(this.states=e,this.electrodeLayer.replaceChildren(...t.map(e1)),this.placeElectrodes())}showContacts(t){for(this.contacts=t;this.contactLayer.children.length<t.length;)this.contactLayer.append(qt("span",{className:"contact"}));[...this.contactLayer.children].forEach((e,i)=>{e.hidden=i>=t.length,e.hidden||Bt(e,(t[i].space?Op:Np)(t[i]))})}setShown({contacts:t,electrodes:e}){this.contactLayer.hidden=!t,this.electrodeLayer.style.display=e?"":"none"}place(t){t&&this.placeElectrodes(),this.placeContacts()}placeElectrodes(){[...this.electrodeLayer.children].forEach((t,e)=>{let[i,s]=this.scene.project(this.electrodes[e]);t.setAttribute("transform",`translate(${i.toFixed(1)},${s.toFixed(1)})`);let r=this.outward[e]!==void 0&&!this.scene.faces(this.electrodes[e],this.outward[e]);t.classList.toggle("is-away",r)})}placeContacts(){let[t,e]=this.scene.size,i=[],s=this.contacts.map((r,o)=>this.wantedPlace(r,this.contactLayer.children[o]));for(let r of s.sort((o,a)=>o.y-a.y)){r.x=F0(r.x,kh,t-r.width-kh),r.y=F0(r.y,kh,e-zh-kh);for(let o of i)i1(r,o)&&(r.y=o.y+zh+2);i.push(r),r.node.style.transform=`translate(${r.x.toFixed(1)}px,${r.y.toFixed(1)}px)`}}wantedPlace(t,e){let{scene:i}=this,[s,r]=i.project(t.position),o=Ed(t,i.frame?.radius??1)*i.pointsPerMetre(),a=e.textContent.length*7+14;return e.classList.toggle("is-away",!i.faces(t.position,new $().copy(t.normal))),{node:e,width:a,x:s-a/2,y:r-o-zh-jA}}};function t1(n,{isFlat:t,centre:e,normal:i,radius:s}){if(!t)return n.clone().sub(e).addScaledVector(i,s*.5).normalize()}function e1({number:n,state:t,colour:e}){let{shape:i,sign:s,word:r}=Al[t],o=li("g",{class:`electrode is-${t}`},QA[i]()),a=e&&t!=="open"&&t!=="shorted";a&&(o.firstChild.style.fill=e);let c=a&&n1(e)<.45,l=li("text",{class:c?"on-dark":"on-light"});l.textContent=n;let h=li("title");if(h.textContent=`Electrode ${n}: ${r}`,o.append(l,h),s){let f=li("text",{class:"sign",x:15,y:-9});f.textContent=s,o.append(f)}return o}function n1(n){let[t,e,i]=n.match(/\d+/g).map(Number);return(.299*t+.587*e+.114*i)/255}function i1(n,t){return n.x<t.x+t.width&&t.x<n.x+n.width&&Math.abs(n.y-t.y)<zh}function F0(n,t,e){return Math.max(t,Math.min(e,n))}var B0=-1e30,s1=`
attribute float value;
varying float shownValue;
varying vec3 viewNormal;
void main() {
  shownValue = value;
  viewNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`,r1=`
uniform sampler2D map;
uniform vec2 range;
uniform vec3 blank;
uniform float shading;
varying float shownValue;
varying vec3 viewNormal;
void main() {
  float share = clamp((shownValue - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 colour = shownValue < -1e20 ? blank : texture2D(map, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  float light = mix(1.0, 0.72 + 0.28 * abs(normalize(viewNormal).z), shading);
  gl_FragColor = vec4(colour * light, 1.0);
}`,Io=class{constructor(t){this.pixels=t.vertex_pixels,this.geometry=z0(t.vertices,t.triangles),this.values=new Float32Array(t.vertices.length/3).fill(B0),this.geometry.setAttribute("value",new Xn(this.values,1)),this.frame=l1(this.geometry),this.material=o1(this.frame.isFlat),this.mesh=new ni(this.geometry,this.material),this.outline=h1(this.geometry),this.objects=[this.mesh,this.outline]}show(t){let{pixels:e}=this;for(let i=0;i<this.values.length;i++){let s=t?.[e[i]];this.values[i]=Number.isFinite(s)?s:B0}this.geometry.attributes.value.needsUpdate=!0}setColours(t,e,i){let{map:s,range:r}=this.material.uniforms;t!==s.value?.image.data&&(s.value?.dispose(),s.value=a1(t)),r.value=[e,i]}setTheme({blank:t,line:e}){this.material.uniforms.blank.value=t,this.outline.material.color.setRGB(...e)}dispose(){this.material.uniforms.map.value?.dispose();for(let t of[this.geometry,this.material,this.outline.geometry,this.outline.material])t.dispose()}};function k0(n){if(n.link_triangles.length!==0)return Ad(z0(n.link_vertices,n.link_triangles))}function Ad(n){let t={polygonOffset:!0,polygonOffsetFactor:2,polygonOffsetUnits:8};return new ni(n,new Fa({color:9147293,side:si,...t}))}function z0(n,t){let e=new Hn;return e.setAttribute("position",new Xn(Float32Array.from(n),3)),e.setIndex(new Xn(Uint32Array.from(t),1)),e.computeVertexNormals(),e.computeBoundingSphere(),e}function o1(n){return new Pi({vertexShader:s1,fragmentShader:r1,side:si,uniforms:{map:{value:null},range:{value:[0,1]},blank:{value:[.5,.5,.5]},shading:{value:n?0:1}}})}function a1(n){let t=new _o(n,n.length/4,1);return t.magFilter=t.minFilter=Bn,t.needsUpdate=!0,t}function l1(n){let{center:t,radius:e}=n.boundingSphere,i=new $,s=0;c1(n,(a,c,l)=>{let h=c.sub(a).cross(l.sub(a));s+=h.length(),i.add(h)});let r=s>0?i.length()/s:0,o=r>.05?i.normalize():new $(0,0,1);return{centre:t.clone(),radius:e||1,normal:o,isFlat:r>.995}}function c1({index:n,attributes:{position:t}},e){let i=s=>new $().fromBufferAttribute(t,n.getX(s));for(let s=0;s+2<n.count;s+=3)e(i(s),i(s+1),i(s+2))}function h1({index:n,attributes:{position:t}}){let e=new Map,i=Uint32Array.from({length:t.count},(a,c)=>{let l=[t.getX(c),t.getY(c),t.getZ(c)].map(h=>Math.round(h*1e6)).join();return e.has(l)||e.set(l,c),e.get(l)}),s=new Map;for(let a=0;a+2<n.count;a+=3){let c=[0,1,2].map(l=>i[n.getX(a+l)]);for(let[l,h]of[[0,1],[1,2],[2,0]]){let f=[c[l],c[h]].sort((d,p)=>d-p),u=f[0]*t.count+f[1];s.set(u,s.has(u)?void 0:f)}}let o=[...s.values()].filter(a=>a!==void 0).flat().map(a=>new $().fromBufferAttribute(t,a));return new Ia(new Hn().setFromPoints(o),new yo)}var u1=.01,Vh=class{constructor(){this.group=new ei,this.links=[],this.skins=new Map,this.reach=new ls}follow(t){let{news:e}=t;e.has("links")&&this.setLinks(t.links);for(let[s,{skin:r,image:o}]of t.skins)r&&e.has(`skin ${s}`)&&this.setSkin(s,r),(e.has(`image ${s}`)||e.has(`skin ${s}`))&&this.setImage(s,o);for(let{frame:s,object:r}of this.parts)f1(r,t.place(s));let i=e.has("links")||[...e].some(s=>s.startsWith("skin "));return i&&this.reach.makeEmpty(),this.reachesFarther()||i}reachesFarther(){let t=this.reach.clone();for(let i of this.partCorners)t.expandByPoint(i);let e=this.reach.isEmpty()||t.min.distanceTo(this.reach.min)+t.max.distanceTo(this.reach.max)>u1;return e&&(this.reach=t),e}get parts(){return[...this.links,...this.skins.values()]}get surfaces(){return[...this.skins.values()].map(({surface:t})=>t)}setLinks(t){for(let{object:e}of this.links)this.remove(e);this.links=t.map(({header:e,points:i})=>({frame:e.frame_id,object:this.add(Ad(d1(i)))}))}setSkin(t,e){let i=this.skins.get(t);i&&this.removeSkin(i);let s=new Io(e),r=this.add(new ei().add(...s.objects));this.skins.set(t,{frame:e.header.frame_id,surface:s,object:r,values:void 0})}setImage(t,e){let i=this.skins.get(t);i&&(i.values=e&&Hl(e,i.values),i.surface.show(i.values))}add(t){return t.matrixAutoUpdate=!1,this.group.add(t),t}remove(t){this.group.remove(t),t.geometry.dispose(),t.material.dispose()}removeSkin({surface:t,object:e}){this.group.remove(e),t.dispose()}showLinks(t){for(let{object:e}of this.links)e.visible=t}dispose(){for(let{object:t}of this.links)this.remove(t);for(let t of this.skins.values())this.removeSkin(t)}get partCorners(){return this.parts.flatMap(({object:t,surface:e})=>{let{geometry:i}=e?.mesh??t;return i.boundingBox||i.computeBoundingBox(),H0(i.boundingBox).map(s=>s.applyMatrix4(t.matrix))})}get corners(){return this.reach.isEmpty()?[]:H0(this.reach).flatMap(t=>t.toArray())}get frame(){if(this.reach.isEmpty())return;let{center:t,radius:e}=this.reach.getBoundingSphere(new Ts),i=new $;for(let{surface:r,object:o}of this.skins.values())i.add(r.frame.normal.clone().transformDirection(o.matrix));let s=i.length()>.1*this.skins.size;return{centre:t,radius:e,normal:s?i.normalize():new $(1,0,0),isFlat:!1}}get skinRadius(){return Math.max(0,...this.surfaces.map(t=>t.frame.radius))}};function f1(n,t){n.matrix.copy(t),n.matrixWorldNeedsUpdate=!0}function d1(n){let t=new Hn,e=Float32Array.from(n.flatMap(({x:i,y:s,z:r})=>[i,s,r]));return t.setAttribute("position",new Xn(e,3)),t.computeVertexNormals(),t.computeBoundingSphere(),t}function H0({min:n,max:t}){let e=[n,t];return e.flatMap(({x:i})=>e.flatMap(({y:s})=>e.map(({z:r})=>new $(i,s,r))))}var Gh=class{constructor(){this.isAutomatic=!0,this.fixed=.2,this.held=0,this.threshold=NaN,this.time=void 0}get maximum(){return this.isAutomatic?Math.max(this.held,this.least):this.fixed}get least(){return this.threshold>0?this.threshold*2:.001}follow(t,e){let i=this.time===void 0?1/0:Math.abs(e-this.time);this.held*=Math.exp(-i/2),this.time=e;for(let s of t)Math.abs(s)>this.held&&(this.held=Math.abs(s))}setAutomatic(t){t||(this.fixed=p1(this.maximum)),this.isAutomatic=t}setFixed(t){this.isAutomatic=!1,this.fixed=t}step(t){this.setFixed(Wh(this.maximum,t))}};function p1(n){return Number(n.toPrecision(2))}function Wh(n,t){let e=10**Math.floor(Math.log10(n)),i=[.1,.2,.5,1,2,5,10,20].map(r=>Number((r*e).toPrecision(2))),s=n*1e-6;return t?i.find(r=>r>n+s):i.findLast(r=>r<n-s)}var V0={type:"change"},Cd={type:"start"},W0={type:"end"},$h=new Sr,G0=new xi,m1=Math.cos(70*hd.DEG2RAD),wn=new $,ui=2*Math.PI,Te={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},Td=1e-6,Xh=class extends Wa{constructor(t,e=null){super(t,e),this.state=Te.NONE,this.target=new $,this.cursor=new $,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.keyRotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:sr.ROTATE,MIDDLE:sr.DOLLY,RIGHT:sr.PAN},this.touches={ONE:rr.ROTATE,TWO:rr.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._cursorStyle="auto",this._domElementKeyEvents=null,this._lastPosition=new $,this._lastQuaternion=new kn,this._lastTargetPosition=new $,this._quat=new kn().setFromUnitVectors(t.up,new $(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new ir,this._sphericalDelta=new ir,this._scale=1,this._panOffset=new $,this._rotateStart=new jt,this._rotateEnd=new jt,this._rotateDelta=new jt,this._panStart=new jt,this._panEnd=new jt,this._panDelta=new jt,this._dollyStart=new jt,this._dollyEnd=new jt,this._dollyDelta=new jt,this._dollyDirection=new $,this._mouse=new jt,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=_1.bind(this),this._onPointerDown=g1.bind(this),this._onPointerUp=y1.bind(this),this._onContextMenu=E1.bind(this),this._onMouseWheel=S1.bind(this),this._onKeyDown=b1.bind(this),this._onTouchStart=w1.bind(this),this._onTouchMove=M1.bind(this),this._onMouseDown=x1.bind(this),this._onMouseMove=v1.bind(this),this._interceptControlDown=A1.bind(this),this._interceptControlUp=T1.bind(this),this.domElement!==null&&this.connect(this.domElement),this.update()}set cursorStyle(t){this._cursorStyle=t,t==="grab"?this.domElement.style.cursor="grab":this.domElement.style.cursor="auto"}get cursorStyle(){return this._cursorStyle}connect(t){super.connect(t),this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.ownerDocument.addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.state=Te.NONE,this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.ownerDocument.removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{capture:!0}),this._controlActive=!1,this._pointers.length=0,this._pointerPositions={},this.domElement.style.touchAction="",this.domElement.style.cursor="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(t){t.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=t}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(V0),this.update(),this.state=Te.NONE}pan(t,e){this._pan(t,e),this.update()}dollyIn(t){this._dollyIn(t),this.update()}dollyOut(t){this._dollyOut(t),this.update()}rotateLeft(t){this._rotateLeft(t),this.update()}rotateUp(t){this._rotateUp(t),this.update()}update(t=null){let e=this.object.position;wn.copy(e).sub(this.target),wn.applyQuaternion(this._quat),this._spherical.setFromVector3(wn),this.autoRotate&&this.state===Te.NONE&&this._rotateLeft(this._getAutoRotationAngle(t)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let i=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(i)&&isFinite(s)&&(i<-Math.PI?i+=ui:i>Math.PI&&(i-=ui),s<-Math.PI?s+=ui:s>Math.PI&&(s-=ui),i<=s?this._spherical.theta=Math.max(i,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(i+s)/2?Math.max(i,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(wn.setFromSpherical(this._spherical),wn.applyQuaternion(this._quatInverse),e.copy(this.target).add(wn),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=wn.length();o=this._clampDistance(a*this._scale);let c=a-o;this.object.position.addScaledVector(this._dollyDirection,c),this.object.updateMatrixWorld(),r=!!c}else if(this.object.isOrthographicCamera){let a=new $(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let c=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=c!==this.object.zoom;let l=new $(this._mouse.x,this._mouse.y,0);l.unproject(this.object),this.object.position.sub(l).add(a),this.object.updateMatrixWorld(),o=wn.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):($h.origin.copy(this.object.position),$h.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot($h.direction))<m1?this.object.lookAt(this.target):(G0.setFromNormalAndCoplanarPoint(this.object.up,this.target),$h.intersectPlane(G0,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>Td||8*(1-this._lastQuaternion.dot(this.object.quaternion))>Td||this._lastTargetPosition.distanceToSquared(this.target)>Td?(this.dispatchEvent(V0),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(t){return t!==null?ui/60*this.autoRotateSpeed*t:ui/60/60*this.autoRotateSpeed}_getZoomScale(t){let e=Math.abs(t*.01);return Math.pow(.95,this.zoomSpeed*e)}_rotateLeft(t){this._sphericalDelta.theta-=t}_rotateUp(t){this._sphericalDelta.phi-=t}_panLeft(t,e){wn.setFromMatrixColumn(e,0),wn.multiplyScalar(-t),this._panOffset.add(wn)}_panUp(t,e){this.screenSpacePanning===!0?wn.setFromMatrixColumn(e,1):(wn.setFromMatrixColumn(e,0),wn.crossVectors(this.object.up,wn)),wn.multiplyScalar(t),this._panOffset.add(wn)}_pan(t,e){let i=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;wn.copy(s).sub(this.target);let r=wn.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*t*r/i.clientHeight,this.object.matrix),this._panUp(2*e*r/i.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(t*(this.object.right-this.object.left)/this.object.zoom/i.clientWidth,this.object.matrix),this._panUp(e*(this.object.top-this.object.bottom)/this.object.zoom/i.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(t,e){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let i=this.domElement.getBoundingClientRect(),s=t-i.left,r=e-i.top,o=i.width,a=i.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(t){return Math.max(this.minDistance,Math.min(this.maxDistance,t))}_handleMouseDownRotate(t){this._rotateStart.set(t.clientX,t.clientY)}_handleMouseDownDolly(t){this._updateZoomParameters(t.clientX,t.clientY),this._dollyStart.set(t.clientX,t.clientY)}_handleMouseDownPan(t){this._panStart.set(t.clientX,t.clientY)}_handleMouseMoveRotate(t){this._rotateEnd.set(t.clientX,t.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(ui*this._rotateDelta.x/e.clientHeight),this._rotateUp(ui*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(t){this._dollyEnd.set(t.clientX,t.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.zoomToCursor&&(this._performCursorZoom=!0,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()),this.update()}_handleMouseMovePan(t){this._panEnd.set(t.clientX,t.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(t){this._updateZoomParameters(t.clientX,t.clientY),t.deltaY<0?this._dollyIn(this._getZoomScale(t.deltaY)):t.deltaY>0&&this._dollyOut(this._getZoomScale(t.deltaY)),this.update()}_handleKeyDown(t){let e=!1;switch(t.code){case this.keys.UP:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(ui*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,this.keyPanSpeed),e=!0;break;case this.keys.BOTTOM:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(-ui*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,-this.keyPanSpeed),e=!0;break;case this.keys.LEFT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(ui*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(this.keyPanSpeed,0),e=!0;break;case this.keys.RIGHT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(-ui*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(-this.keyPanSpeed,0),e=!0;break}e&&(t.preventDefault(),this.update())}_handleTouchStartRotate(t){if(this._pointers.length===1)this._rotateStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),i=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._rotateStart.set(i,s)}}_handleTouchStartPan(t){if(this._pointers.length===1)this._panStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),i=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panStart.set(i,s)}}_handleTouchStartDolly(t){let e=this._getSecondPointerPosition(t),i=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(i*i+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enablePan&&this._handleTouchStartPan(t)}_handleTouchStartDollyRotate(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enableRotate&&this._handleTouchStartRotate(t)}_handleTouchMoveRotate(t){if(this._pointers.length==1)this._rotateEnd.set(t.pageX,t.pageY);else{let i=this._getSecondPointerPosition(t),s=.5*(t.pageX+i.x),r=.5*(t.pageY+i.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(ui*this._rotateDelta.x/e.clientHeight),this._rotateUp(ui*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(t){if(this._pointers.length===1)this._panEnd.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),i=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panEnd.set(i,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(t){let e=this._getSecondPointerPosition(t),i=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(i*i+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(t.pageX+e.x)*.5,a=(t.pageY+e.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enablePan&&this._handleTouchMovePan(t)}_handleTouchMoveDollyRotate(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enableRotate&&this._handleTouchMoveRotate(t)}_addPointer(t){this._pointers.push(t.pointerId)}_removePointer(t){delete this._pointerPositions[t.pointerId];for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId){this._pointers.splice(e,1);return}}_isTrackingPointer(t){for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId)return!0;return!1}_trackPointer(t){let e=this._pointerPositions[t.pointerId];e===void 0&&(e=new jt,this._pointerPositions[t.pointerId]=e),e.set(t.pageX,t.pageY)}_getSecondPointerPosition(t){let e=t.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[e]}_customWheelEvent(t){let e=t.deltaMode,i={clientX:t.clientX,clientY:t.clientY,deltaY:t.deltaY};switch(e){case 1:i.deltaY*=16;break;case 2:i.deltaY*=100;break}return t.ctrlKey&&!this._controlActive&&(i.deltaY*=10),i}};function g1(n){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(n.pointerId),this.domElement.ownerDocument.addEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(n)&&(this._addPointer(n),n.pointerType==="touch"?this._onTouchStart(n):this._onMouseDown(n),this._cursorStyle==="grab"&&(this.domElement.style.cursor="grabbing")))}function _1(n){this.enabled!==!1&&(n.pointerType==="touch"?this._onTouchMove(n):this._onMouseMove(n))}function y1(n){switch(this._removePointer(n),this._pointers.length){case 0:this.domElement.releasePointerCapture(n.pointerId),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(W0),this.state=Te.NONE,this._cursorStyle==="grab"&&(this.domElement.style.cursor="grab");break;case 1:let t=this._pointers[0],e=this._pointerPositions[t];this._onTouchStart({pointerId:t,pageX:e.x,pageY:e.y});break}}function x1(n){let t;switch(n.button){case 0:t=this.mouseButtons.LEFT;break;case 1:t=this.mouseButtons.MIDDLE;break;case 2:t=this.mouseButtons.RIGHT;break;default:t=-1}switch(t){case sr.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(n),this.state=Te.DOLLY;break;case sr.ROTATE:if(n.ctrlKey||n.metaKey||n.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(n),this.state=Te.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(n),this.state=Te.ROTATE}break;case sr.PAN:if(n.ctrlKey||n.metaKey||n.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(n),this.state=Te.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(n),this.state=Te.PAN}break;default:this.state=Te.NONE}this.state!==Te.NONE&&this.dispatchEvent(Cd)}function v1(n){switch(this.state){case Te.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(n);break;case Te.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(n);break;case Te.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(n);break}}function S1(n){this.enabled===!1||this.enableZoom===!1||this.state!==Te.NONE||(n.preventDefault(),this.dispatchEvent(Cd),this._handleMouseWheel(this._customWheelEvent(n)),this.dispatchEvent(W0))}function b1(n){this.enabled!==!1&&this._handleKeyDown(n)}function w1(n){switch(this._trackPointer(n),this._pointers.length){case 1:switch(this.touches.ONE){case rr.ROTATE:if(this.enableRotate===!1){this.state=Te.NONE;break}this._handleTouchStartRotate(n),this.state=Te.TOUCH_ROTATE;break;case rr.PAN:if(this.enablePan===!1){this.state=Te.NONE;break}this._handleTouchStartPan(n),this.state=Te.TOUCH_PAN;break;default:this.state=Te.NONE}break;case 2:switch(this.touches.TWO){case rr.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(n),this.state=Te.TOUCH_DOLLY_PAN;break;case rr.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(n),this.state=Te.TOUCH_DOLLY_ROTATE;break;default:this.state=Te.NONE}break;default:this.state=Te.NONE}this.state!==Te.NONE&&this.dispatchEvent(Cd)}function M1(n){switch(this._trackPointer(n),this.state){case Te.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(n),this.update();break;case Te.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(n),this.update();break;case Te.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(n),this.update();break;case Te.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(n),this.update();break;default:this.state=Te.NONE}}function E1(n){this.enabled!==!1&&n.preventDefault()}function A1(n){n.key==="Control"&&(this._controlActive=!0,this.domElement.ownerDocument.addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function T1(n){n.key==="Control"&&(this._controlActive=!1,this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var Rd=40*Math.PI/180,C1=1.14,R1=1.4;function $0({normal:n,isFlat:t}){let e=I1(n);if(t)return{up:e,direction:n.clone()};let i=new $(0,0,1),s=new $().crossVectors(e,n).normalize(),r=n.clone().multiplyScalar(Math.cos(Rd)).addScaledVector(e,-Math.sin(Rd));return Math.abs(n.z)<.5&&r.copy(n).addScaledVector(i,Math.tan(Rd/2)),{up:i,direction:r.addScaledVector(s,.35).normalize()}}function I1(n){let t=Math.abs(n.z)>.7?new $(0,1,0):new $(0,0,1);return t.addScaledVector(n,-t.dot(n)).normalize()}function X0(n,t,{up:e,direction:i},s){let r=s?R1:C1,o=new $().crossVectors(e,i).normalize(),a=[o,new $().crossVectors(i,o),i],[c,l,h]=a.map(_=>P1(t,_)),f=new $;[c,l,h].forEach(([_,m],g)=>f.addScaledVector(a[g],(_+m)/2));let u=Math.tan(n.fov*Math.PI/360),d=[u*n.aspect,u],p=0;return q0(t,_=>{_.sub(f);let m=_.dot(i);d.forEach((g,v)=>p=Math.max(p,Math.abs(_.dot(a[v]))*r/g+m))}),{target:f,position:f.clone().addScaledVector(i,p||1)}}function P1(n,t){let[e,i]=[1/0,-1/0];return q0(n,s=>{let r=s.dot(t);e=Math.min(e,r),i=Math.max(i,r)}),[e,i]}function q0(n,t){let e=new $;for(let i=0;i+2<n.length;i+=3)t(e.fromArray(n,i))}function Y0(n,t,e){let{object:i,target:s}=n,r=new $(0,1,0),o=i.position.clone().sub(s),a=new ir,c=i.quaternion.clone().setFromUnitVectors(i.up,r);a.setFromVector3(o.applyQuaternion(c)),a.theta+=t,a.phi+=e,a.makeSafe(),i.position.setFromSpherical(a).applyQuaternion(c.clone().invert()).add(s),n.update()}function Z0(n,t){let{object:e,target:i}=n;e.position.sub(i).multiplyScalar(t).add(i),n.update()}var L1=2,qh=class{constructor(t,{keepsPixels:e,onView:i}){this.renderer=new Oh({canvas:t,alpha:!0,antialias:!D1(),powerPreference:"low-power",preserveDrawingBuffer:e}),this.canvas=t,this.onView=i,this.camera=new ti(32,1,.01,10),this.objects=new Ta,this.markers=new Bh,this.objects.add(this.markers.group,new za(16777215,6317678,1.6),this.camera),N1(this.camera),this.theme=void 0,this.surface=void 0,this.link=void 0,this.figure=void 0,this.isFitted=!0,this.size=[1,1]}get frame(){return this.figureFrame??this.surface?.frame}setFigure(t){t!==this.figure&&(this.figure&&this.objects.remove(this.figure.group),this.figure?.dispose(),this.figure=t,this.figureFrame=void 0,t&&this.objects.add(t.group),this.markers.reset())}fitFigure(){this.figureFrame=this.figure.frame,this.theme&&this.setTheme(this.theme),this.figureFrame&&this.isFitted&&this.resetView()}setSkin(t){this.removeSkin(),this.surface=new Io(t),this.link=k0(t),this.objects.add(...this.surface.objects,...this.link?[this.link]:[]),this.markers.reset(),this.theme&&this.setTheme(this.theme),this.resetView()}removeSkin(){this.surface&&(this.objects.remove(...this.surface.objects),this.surface.dispose(),this.link&&this.removeLink(),this.surface=void 0,this.markers.reset())}removeLink(){this.objects.remove(this.link),this.link.geometry.dispose(),this.link.material.dispose(),this.link=void 0}get surfaces(){return this.figure?.surfaces??(this.surface?[this.surface]:[])}setTheme(t){this.theme=t;let e=new ue().setRGB(...t.line,"srgb").toArray();for(let i of this.surfaces)i.setTheme({blank:t.blank,line:e})}showLink(t){this.link&&(this.link.visible=t),this.figure?.showLinks(t)}showContacts(t){this.markers.show(t,this.figure?.skinRadius??this.frame?.radius??1)}resetView(){if(!this.frame)return;let t=$0(this.frame),{target:e,position:i}=X0(this.camera,this.vertices,t,!!this.link);this.camera.up.copy(t.up),this.camera.position.copy(i),this.replaceControls(e),this.isFitted=!0,this.onView()}get vertices(){return this.figure?.corners??this.surface.geometry.attributes.position.array}replaceControls(t){this.controls?.dispose(),this.controls=new Xh(this.camera,this.canvas),this.controls.target.copy(t),this.controls.minDistance=this.frame.radius*.2,this.controls.maxDistance=this.frame.radius*30,this.controls.update(),this.controls.addEventListener("change",()=>this.moved())}moved(){this.isFitted=!1,this.onView()}turn(t,e){this.controls&&Y0(this.controls,t,e)}zoom(t){this.controls&&Z0(this.controls,t)}resize(t,e,i){this.renderer.setPixelRatio(Math.min(i,L1)),this.renderer.setSize(t,e,!1),this.size=[t,e],this.camera.aspect=t/e,this.camera.updateProjectionMatrix(),this.isFitted?this.resetView():this.onView()}draw(){this.frame&&this.setDepths(),this.markers.face(this.camera),this.renderer.render(this.objects,this.camera)}setDepths(){let{centre:t,radius:e}=this.frame,i=this.camera.position.distanceTo(t),s=this.link?.geometry.boundingSphere,r=1.6*Math.max(e,s?s.center.distanceTo(t)+s.radius:0);this.camera.near=Math.max(i-r,i*.01),this.camera.far=i+r,this.camera.updateProjectionMatrix(),this.camera.updateMatrixWorld()}project({x:t,y:e,z:i}){let s=new $(t,e,i).project(this.camera),[r,o]=this.size;return[(s.x+1)/2*r,(1-s.y)/2*o]}faces(t,e){return new $().copy(this.camera.position).sub(t).dot(e)>0}pointsPerMetre(){let t=this.camera.position.distanceTo(this.controls?.target??new $);return this.size[1]/(2*t*Math.tan(this.camera.fov*Math.PI/360))}axes(){let t=this.camera.matrixWorldInverse;return[[1,0,0],[0,1,0],[0,0,1]].map(e=>new $(...e).transformDirection(t).toArray())}};function D1(){let n=document.createElement("canvas").getContext("webgl2"),t=n?.getExtension("WEBGL_debug_renderer_info"),e=t?String(n.getParameter(t.UNMASKED_RENDERER_WEBGL)):"";return n?.getExtension("WEBGL_lose_context")?.loseContext(),/swiftshader|llvmpipe|softpipe|software|basic render/i.test(e)}function N1(n){let t=new Ga(16777215,1.4);t.position.set(.3,.5,1),n.add(t,t.target)}var O1=["skin","image","contacts","health","view","look","new","robot"],U1=6,F1=110,Yh=class{constructor(t,{keepsPixels:e}){this.session=t,this.scale=new Gh,this.map="viridis",this.shows={contacts:!0,electrodes:!0,link:!0},this.values=void 0,this.framesDrawn=0,this.lastDrawnDeviceTime=0,this.canvas=J("canvas"),this.scene=this.openScene(e),this.scene&&(this.labels=new Hh(J("labels"),this.scene),this.canvas.addEventListener("webglcontextlost",()=>t.lacks("The browser has lost the graphics card. The picture comes back by itself, or when the page is reloaded.")),this.canvas.addEventListener("webglcontextrestored",()=>t.lacks("")),new ResizeObserver(()=>this.resize()).observe(this.canvas),t.listen(i=>this.update(i)))}openScene(t){try{return new qh(this.canvas,{keepsPixels:t,onView:()=>this.session.changed("view")})}catch{this.session.lacks("The picture needs WebGL, which this browser does not offer. Numbers and plots work without it.");return}}resize(){let{clientWidth:t,clientHeight:e}=this.canvas;t===0||e===0||(this.scene.resize(t,e,window.devicePixelRatio),this.session.changed("view"))}setMap(t){this.map=t,this.table=void 0,this.session.changed("look")}setShown(t){Object.assign(this.shows,t),this.session.changed("look")}get range(){let{maximum:t}=this.scale;return[gr[this.map].isDiverging?-t:0,t]}update(t){if(!O1.some(s=>t.has(s)))return;let{shown:e,isWhole:i}=this.session;(t.has("new")||i!==!!this.scene.figure)&&this.showWhole(i),i&&t.has("robot")&&this.showRobot(),(t.has("skin")||t.has("new"))&&this.showSkin(e.skin),t.has("image")&&this.showImage(e.image),t.has("contacts")&&this.showContacts(e.contacts?.contacts??[]),(t.has("health")||t.has("skin"))&&this.showHealth(e),(t.has("look")||t.has("skin"))&&this.showLook(),this.draw(t)}showSkin(t){if(this.values=void 0,!t)return this.showContacts([]),this.labels.setElectrodes([],{}),this.scene.removeSkin();this.scale.threshold=t.contact_threshold,this.scene.setSkin(t),this.labels.setElectrodes(t.electrodes,this.scene.frame),this.session.shown.image&&this.showImage(this.session.shown.image)}showImage(t){if(!t)return this.scene.surface?.show(void 0);this.values=Hl(t,this.values),this.scale.follow(this.values,Number(t.device_time_us)/1e6),this.scene.surface?.show(this.values)}showContacts(t){this.scene.showContacts(this.shows.contacts?t:[]),this.labels.showContacts(t)}showWhole(t){this.scene.setFigure(t?new Vh:void 0),this.scene.isFitted=!0}showRobot(){let{robot:t}=this.session,{figure:e}=this.scene,i=e.follow(t),s=[...t.skins.values()].map(({skin:r})=>r).filter(Boolean);this.scale.threshold=Math.max(...s.map(({contact_threshold:r})=>r));for(let{values:r}of e.skins.values())r&&this.scale.follow(r,performance.now()/1e3);t.news.clear(),i&&(this.scene.fitFigure(),this.showLook()),this.showContacts(t.contacts)}get contacts(){let{isWhole:t,robot:e,shown:i}=this.session;return t?e.contacts:i.contacts?.contacts??[]}showHealth({skin:t,health:e}){t&&this.labels.showElectrodes(Tl(t.electrodes.length/3,e))}showLook(){this.labels.setShown(this.shows),this.scene.showLink(this.shows.link),this.scene.setTheme(z1()),this.showContacts(this.contacts)}draw(t){this.table??=Gp(this.map);let[e,i]=this.range;for(let r of this.scene.surfaces)r.setColours(this.table,e,i);this.scene.draw();let s=["view","skin","robot"].some(r=>t.has(r));this.labels.place(s),J("view-foot").hidden=!this.scene.frame,s&&this.scene.frame&&this.showRuler(),this.showColourBar(e,i),this.framesDrawn++,t.has("image")&&this.session.shown.image&&(this.lastDrawnDeviceTime=Number(this.session.shown.image.device_time_us))}showColourBar(t,e){let i=[this.map,t,e,this.scale.isAutomatic].join();i!==this.barKey&&(this.barKey=i,J("bar-colours").style.background=Wp(this.map),Bt(J("bar-mode"),this.scale.isAutomatic?"auto":"fixed"),Gn(J("bar-ticks"),B1(t,e),()=>qt("li"),(s,{text:r,value:o})=>{Bt(s,r),s.style.bottom=`${100*(o-t)/(e-t)}%`}))}showRuler(){let t=this.scene.pointsPerMetre(),e=Wh(F1/t,!1);J("ruler").style.width=`${e*t}px`,Bt(J("ruler-text"),e<1?`${K0(e*1e3)} mm`:`${K0(e)} m`),J("axes").replaceChildren(...k1(this.scene.axes()))}};function B1(n,t){let e=Wh((t-n)/U1,!0),i=Math.max(0,-Math.floor(Math.log10(e)+1e-9)),s=Math.ceil(n/e-1e-9),r=Math.floor(t/e+1e-9)-s+1;return Array.from({length:r},(o,a)=>({value:(s+a)*e,text:((s+a)*e).toFixed(i)}))}function K0(n){return Number(n.toPrecision(2))}function k1(n){return n.map(([e,i,s],r)=>({right:e,up:i,towards:s,name:"xyz"[r]})).sort((e,i)=>e.towards-i.towards).map(({right:e,up:i,name:s})=>{let r=li("text",{x:e*25,y:-i*25});return r.textContent=s,li("g",{},li("line",{x2:e*17,y2:-i*17}),r)})}function z1(){let n=getComputedStyle(document.documentElement),t=e=>n.getPropertyValue(e).trim().split(/\s+/).map(i=>Number(i)/255);return{blank:t("--skin-blank"),line:t("--skin-line")}}var J0=[.1,.25,.5,1,2,4],H1=16,Zh=class{constructor(t,e){this.recording=t,this.on=e,this.position=t.start,this.speed=1,this.isPlaying=!1,this.shown=new Map,this.wanted=void 0,this.isSeeking=!1,this.showFirst()}async showFirst(){await this.seek(this.recording.start);let e=this.position===this.recording.start&&!this.isPlaying&&!this.isClosed&&await this.recording.neighbour(this.recording.start-1n,!0).catch(()=>{});e&&this.position===this.recording.start&&await this.seek(e)}get seconds(){return Number(this.position-this.recording.start)/1e9}get isAtEnd(){return this.position>=this.recording.end}setSpeed(t){this.speed=t,this.on.change()}play(){this.isPlaying||(this.isAtEnd&&this.seek(this.recording.start),this.isPlaying=!0,this.ticked=performance.now(),this.timer=setInterval(()=>this.tick(),H1),this.on.change())}pause(){clearInterval(this.timer),this.isPlaying=!1,this.on.change()}toggle(){this.isPlaying?this.pause():this.play()}close(){clearInterval(this.timer),this.isPlaying=!1,this.isClosed=!0}seekSeconds(t){return this.seek(this.recording.start+BigInt(Math.round(t*1e9)))}async step(t){this.pause();let e=await this.recording.neighbour(this.position,t);e!==void 0&&await this.seek(e)}tick(){let t=performance.now(),e=BigInt(Math.round((t-this.ticked)*1e6*this.speed));this.ticked=t,!this.isSeeking&&(this.seek(this.position+e).catch(()=>this.pause()),this.isAtEnd&&this.pause())}async seek(t){let{start:e,end:i}=this.recording;if(this.position=t<e?e:t>i?i:t,this.wanted=this.position,this.on.change(),!this.isSeeking){this.isSeeking=!0;try{for(;this.wanted!==void 0&&!this.isClosed;)await this.showWanted()}catch(s){this.pause(),this.on.error(s)}finally{this.isSeeking=!1}}}async showWanted(){let t=this.wanted;this.wanted=void 0;let e=await this.recording.at(t);if(!this.isClosed){this.forgetOthers(new Set(e.map(({topic:i})=>i)));for(let i of e)this.shown.get(i.topic)!==i&&(this.shown.set(i.topic,i),this.on.message(i.topic,i.schema,i.bytes,i.logTime))}}forgetOthers(t){for(let e of[...this.shown.keys()].filter(i=>!t.has(i)))this.shown.delete(e),this.on.message(e)}};var V1="uplot",G1="u-hz",W1="u-vt",$1="u-title",X1="u-wrap",q1="u-under",Y1="u-over",Z1="u-axis",Rr="u-off",K1="u-select",J1="u-cursor-x",j1="u-cursor-y",Q1="u-cursor-pt",tT="u-legend",eT="u-live",nT="u-inline",iT="u-series",sT="u-marker",j0="u-label",rT="u-value",rl="width",ol="height";var Q0="bottom",Po="left",Id="right",qd="#000",t_=qd+"0",Pd="mousemove",e_="mousedown",Ld="mouseup",n_="mouseenter",i_="mouseleave",s_="dblclick",oT="resize",aT="scroll",r_="change",tu="dppxchange",Yd="--",Bo=typeof window<"u",Fd=Bo?document:null,Do=Bo?window:null,lT=Bo?navigator:null,Ce,Kh;function Bd(){let n=devicePixelRatio;Ce!=n&&(Ce=n,Kh&&zd(r_,Kh,Bd),Kh=matchMedia(`(min-resolution: ${Ce-.001}dppx) and (max-resolution: ${Ce+.001}dppx)`),Ir(r_,Kh,Bd),Do.dispatchEvent(new CustomEvent(tu)))}function bi(n,t){if(t!=null){let e=n.classList;!e.contains(t)&&e.add(t)}}function kd(n,t){let e=n.classList;e.contains(t)&&e.remove(t)}function Ye(n,t,e){n.style[t]=e+"px"}function qi(n,t,e,i){let s=Fd.createElement(n);return t!=null&&bi(s,t),e?.insertBefore(s,i),s}function Li(n,t){return qi("div",n,t)}var o_=new WeakMap;function fs(n,t,e,i,s){let r="translate("+t+"px,"+e+"px)",o=o_.get(n);r!=o&&(n.style.transform=r,o_.set(n,r),t<0||e<0||t>i||e>s?bi(n,Rr):kd(n,Rr))}var a_=new WeakMap;function l_(n,t,e){let i=t+e,s=a_.get(n);i!=s&&(a_.set(n,i),n.style.background=t,n.style.borderColor=e)}var c_=new WeakMap;function h_(n,t,e,i){let s=t+""+e,r=c_.get(n);s!=r&&(c_.set(n,s),n.style.height=e+"px",n.style.width=t+"px",n.style.marginLeft=i?-t/2+"px":0,n.style.marginTop=i?-e/2+"px":0)}var Zd={passive:!0},cT={...Zd,capture:!0};function Ir(n,t,e,i){t.addEventListener(n,e,i?cT:Zd)}function zd(n,t,e,i){t.removeEventListener(n,e,Zd)}Bo&&Bd();function Yi(n,t,e,i){let s;e=e||0,i=i||t.length-1;let r=i<=2147483647;for(;i-e>1;)s=r?e+i>>1:wi((e+i)/2),t[s]<n?e=s:i=s;return n-t[e]<=t[i]-n?e:i}function B_(n){return(e,i,s)=>{let r=-1,o=-1;for(let a=i;a<=s;a++)if(n(e[a])){r=a;break}for(let a=s;a>=i;a--)if(n(e[a])){o=a;break}return[r,o]}}var k_=n=>n!=null,z_=n=>n!=null&&n>0,iu=B_(k_),hT=B_(z_);function uT(n,t,e,i=0,s=!1){let r=s?hT:iu,o=s?z_:k_;[t,e]=r(n,t,e);let a=n[t],c=n[t];if(t>-1)if(i==1)a=n[t],c=n[e];else if(i==-1)a=n[e],c=n[t];else for(let l=t;l<=e;l++){let h=n[l];o(h)&&(h<a?a=h:h>c&&(c=h))}return[a??ze,c??-ze]}function su(n,t,e,i){let s=d_(n),r=d_(t);n==t&&(s==-1?(n*=e,t/=e):(n/=e,t*=e));let o=e==10?Ds:H_,a=s==1?wi:Di,c=r==1?Di:wi,l=a(o(En(n))),h=c(o(En(t))),f=No(e,l),u=No(e,h);return e==10&&(l<0&&(f=He(f,-l)),h<0&&(u=He(u,-h))),i||e==2?(n=f*s,t=u*r):(n=$_(n,f),t=ru(t,u)),[n,t]}function Kd(n,t,e,i){let s=su(n,t,e,i);return n==0&&(s[0]=0),t==0&&(s[1]=0),s}var Jd=.1,u_={mode:3,pad:Jd},ll={pad:0,soft:null,mode:0},fT={min:ll,max:ll};function eu(n,t,e,i){return ou(e)?f_(n,t,e):(ll.pad=e,ll.soft=i?0:null,ll.mode=i?3:0,f_(n,t,fT))}function Ee(n,t){return n??t}function dT(n,t,e){for(t=Ee(t,0),e=Ee(e,n.length-1);t<=e;){if(n[t]!=null)return!0;t++}return!1}function f_(n,t,e){let i=e.min,s=e.max,r=Ee(i.pad,0),o=Ee(s.pad,0),a=Ee(i.hard,-ze),c=Ee(s.hard,ze),l=Ee(i.soft,ze),h=Ee(s.soft,-ze),f=Ee(i.mode,0),u=Ee(s.mode,0),d=t-n,p=Ds(d),_=ri(En(n),En(t)),m=Ds(_),g=En(m-p);(d<1e-24||g>10)&&(d=0,(n==0||t==0)&&(d=1e-24,f==2&&l!=ze&&(r=0),u==2&&h!=-ze&&(o=0)));let v=d||_||1e3,T=Ds(v),S=No(10,wi(T)),C=v*(d==0?n==0?.1:1:r),E=He($_(n-C,S/10),24),y=n>=l&&(f==1||f==3&&E<=l||f==2&&E>=l)?l:ze,w=ri(a,E<y&&n>=y?y:Zi(y,E)),V=v*(d==0?t==0?.1:1:o),N=He(ru(t+V,S/10),24),L=t<=h&&(u==1||u==3&&N>=h||u==2&&N<=h)?h:-ze,B=Zi(c,N>L&&t<=L?L:ri(L,N));return w==B&&w==0&&(B=100),[w,B]}var pT=new Intl.NumberFormat(Bo?lT.language:"en-US"),jd=n=>pT.format(n),Mi=Math,Qh=Mi.PI,En=Mi.abs,wi=Mi.floor,Mn=Mi.round,Di=Mi.ceil,Zi=Mi.min,ri=Mi.max,No=Mi.pow,d_=Mi.sign,Ds=Mi.log10,H_=Mi.log2,mT=(n,t=1)=>Mi.sinh(n)*t,Dd=(n,t=1)=>Mi.asinh(n/t),ze=1/0;function p_(n){return(Ds((n^n>>31)-(n>>31))|0)+1}function Hd(n,t,e){return Zi(ri(n,t),e)}function V_(n){return typeof n=="function"}function xe(n){return V_(n)?n:()=>n}var gT=()=>{},G_=n=>n,W_=(n,t)=>t,_T=n=>null,m_=n=>!0,g_=(n,t)=>n==t,yT=/\.\d*?(?=9{6,}|0{6,})/gm,Pr=n=>{if(q_(n)||cr.has(n))return n;let t=`${n}`,e=t.match(yT);if(e==null)return n;let i=e[0].length-1;if(t.indexOf("e-")!=-1){let[s,r]=t.split("e");return+`${Pr(s)}e${r}`}return He(n,i)};function Tr(n,t){return Pr(He(Pr(n/t))*t)}function ru(n,t){return Pr(Di(Pr(n/t))*t)}function $_(n,t){return Pr(wi(Pr(n/t))*t)}function He(n,t=0){if(q_(n))return n;let e=10**t,i=n*e*(1+Number.EPSILON);return Mn(i)/e}var cr=new Map;function X_(n){return((""+n).split(".")[1]||"").length}function hl(n,t,e,i){let s=[],r=i.map(X_);for(let o=t;o<e;o++){let a=En(o),c=He(No(n,o),a);for(let l=0;l<i.length;l++){let h=n==10?+`${i[l]}e${o}`:i[l]*c,f=(o>=0?0:a)+(o>=r[l]?0:r[l]),u=n==10?h:He(h,f);s.push(u),cr.set(u,f)}}return s}var cl={},Qd=[],Oo=[null,null],lr=Array.isArray,q_=Number.isInteger,xT=n=>n===void 0;function __(n){return typeof n=="string"}function ou(n){let t=!1;if(n!=null){let e=n.constructor;t=e==null||e==Object}return t}function vT(n){return n!=null&&typeof n=="object"}var ST=Object.getPrototypeOf(Uint8Array),Y_="__proto__";function Uo(n,t=ou){let e;if(lr(n)){let i=n.find(s=>s!=null);if(lr(i)||t(i)){e=Array(n.length);for(let s=0;s<n.length;s++)e[s]=Uo(n[s],t)}else e=n.slice()}else if(n instanceof ST)e=n.slice();else if(t(n)){e={};for(let i in n)i!=Y_&&(e[i]=Uo(n[i],t))}else e=n;return e}function gn(n){let t=arguments;for(let e=1;e<t.length;e++){let i=t[e];for(let s in i)s!=Y_&&(ou(n[s])?gn(n[s],Uo(i[s])):n[s]=Uo(i[s]))}return n}var bT=0,wT=1,MT=2;function ET(n,t,e){for(let i=0,s,r=-1;i<t.length;i++){let o=t[i];if(o>r){for(s=o-1;s>=0&&n[s]==null;)n[s--]=null;for(s=o+1;s<e&&n[s]==null;)n[r=s++]=null}}}function AT(n,t){if(RT(n)){let o=n[0].slice();for(let a=1;a<n.length;a++)o.push(...n[a].slice(1));return IT(o[0])||(o=CT(o)),o}let e=new Set;for(let o=0;o<n.length;o++){let c=n[o][0],l=c.length;for(let h=0;h<l;h++)e.add(c[h])}let i=[Array.from(e).sort((o,a)=>o-a)],s=i[0].length,r=new Map;for(let o=0;o<s;o++)r.set(i[0][o],o);for(let o=0;o<n.length;o++){let a=n[o],c=a[0];for(let l=1;l<a.length;l++){let h=a[l],f=Array(s).fill(void 0),u=t?t[o][l]:wT,d=[];for(let p=0;p<h.length;p++){let _=h[p],m=r.get(c[p]);_===null?u!=bT&&(f[m]=_,u==MT&&d.push(m)):f[m]=_}ET(f,d,s),i.push(f)}}return i}var TT=typeof queueMicrotask>"u"?n=>Promise.resolve().then(n):queueMicrotask;function CT(n){let t=n[0],e=t.length,i=Array(e);for(let r=0;r<i.length;r++)i[r]=r;i.sort((r,o)=>t[r]-t[o]);let s=[];for(let r=0;r<n.length;r++){let o=n[r],a=Array(e);for(let c=0;c<e;c++)a[c]=o[i[c]];s.push(a)}return s}function RT(n){let t=n[0][0],e=t.length;for(let i=1;i<n.length;i++){let s=n[i][0];if(s.length!=e)return!1;if(s!=t){for(let r=0;r<e;r++)if(s[r]!=t[r])return!1}}return!0}function IT(n,t=100){let e=n.length;if(e<=1)return!0;let i=0,s=e-1;for(;i<=s&&n[i]==null;)i++;for(;s>=i&&n[s]==null;)s--;if(s<=i)return!0;let r=ri(1,wi((s-i+1)/t));for(let o=n[i],a=i+r;a<=s;a+=r){let c=n[a];if(c!=null){if(c<=o)return!1;o=c}}return!0}var Z_=["January","February","March","April","May","June","July","August","September","October","November","December"],K_=["Sunday","Monday","Tuesday","Wednesday","Thursday","Friday","Saturday"];function J_(n){return n.slice(0,3)}var PT=K_.map(J_),LT=Z_.map(J_),DT={MMMM:Z_,MMM:LT,WWWW:K_,WWW:PT};function sl(n){return(n<10?"0":"")+n}function NT(n){return(n<10?"00":n<100?"0":"")+n}var OT={YYYY:n=>n.getFullYear(),YY:n=>(n.getFullYear()+"").slice(2),MMMM:(n,t)=>t.MMMM[n.getMonth()],MMM:(n,t)=>t.MMM[n.getMonth()],MM:n=>sl(n.getMonth()+1),M:n=>n.getMonth()+1,DD:n=>sl(n.getDate()),D:n=>n.getDate(),WWWW:(n,t)=>t.WWWW[n.getDay()],WWW:(n,t)=>t.WWW[n.getDay()],HH:n=>sl(n.getHours()),H:n=>n.getHours(),h:n=>{let t=n.getHours();return t==0?12:t>12?t-12:t},AA:n=>n.getHours()>=12?"PM":"AM",aa:n=>n.getHours()>=12?"pm":"am",a:n=>n.getHours()>=12?"p":"a",mm:n=>sl(n.getMinutes()),m:n=>n.getMinutes(),ss:n=>sl(n.getSeconds()),s:n=>n.getSeconds(),fff:n=>NT(n.getMilliseconds())};function tp(n,t){t=t||DT;let e=[],i=/\{([a-z]+)\}|[^{]+/gi,s;for(;s=i.exec(n);)e.push(s[0][0]=="{"?OT[s[1]]:s[0]);return r=>{let o="";for(let a=0;a<e.length;a++)o+=typeof e[a]=="string"?e[a]:e[a](r,t);return o}}var UT=new Intl.DateTimeFormat().resolvedOptions().timeZone;function FT(n,t){let e;return t=="UTC"||t=="Etc/UTC"?e=new Date(+n+n.getTimezoneOffset()*6e4):t==UT?e=n:(e=new Date(n.toLocaleString("en-US",{timeZone:t})),e.setMilliseconds(n.getMilliseconds())),e}var j_=n=>n%1==0,nu=[1,2,2.5,5],BT=hl(10,-32,0,nu),Q_=hl(10,0,32,nu),kT=Q_.filter(j_),Cr=BT.concat(Q_),ep=`
`,ty="{YYYY}",y_=ep+ty,ey="{M}/{D}",al=ep+ey,Jh=al+"/{YY}",ny="{aa}",zT="{h}:{mm}",Lo=zT+ny,x_=ep+Lo,v_=":{ss}",Pe=null;function iy(n){let t=n*1e3,e=t*60,i=e*60,s=i*24,r=s*30,o=s*365,c=(n==1?hl(10,0,3,nu).filter(j_):hl(10,-3,0,nu)).concat([t,t*5,t*10,t*15,t*30,e,e*5,e*10,e*15,e*30,i,i*2,i*3,i*4,i*6,i*8,i*12,s,s*2,s*3,s*4,s*5,s*6,s*7,s*8,s*9,s*10,s*15,r,r*2,r*3,r*4,r*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),l=[[o,ty,Pe,Pe,Pe,Pe,Pe,Pe,1],[s*28,"{MMM}",y_,Pe,Pe,Pe,Pe,Pe,1],[s,ey,y_,Pe,Pe,Pe,Pe,Pe,1],[i,"{h}"+ny,Jh,Pe,al,Pe,Pe,Pe,1],[e,Lo,Jh,Pe,al,Pe,Pe,Pe,1],[t,v_,Jh+" "+Lo,Pe,al+" "+Lo,Pe,x_,Pe,1],[n,v_+".{fff}",Jh+" "+Lo,Pe,al+" "+Lo,Pe,x_,Pe,1]];function h(f){return(u,d,p,_,m,g)=>{let v=[],T=m>=o,S=m>=r&&m<o,C=f(p),E=He(C*n,3),y=Nd(C.getFullYear(),T?0:C.getMonth(),S||T?1:C.getDate()),w=He(y*n,3);if(S||T){let V=S?m/r:0,N=T?m/o:0,L=E==w?E:He(Nd(y.getFullYear()+N,y.getMonth()+V,1)*n,3),B=new Date(Mn(L/n)),F=B.getFullYear(),R=B.getMonth();for(let U=0;L<=_;U++){let X=Nd(F+N*U,R+V*U,1),G=X-f(He(X*n,3));L=He((+X+G)*n,3),L<=_&&v.push(L)}}else{let V=m>=s?s:m,N=wi(p)-wi(E),L=w+N+ru(E-w,V);v.push(L);let B=f(L),F=B.getHours()+B.getMinutes()/e+B.getSeconds()/i,R=m/i,U=u.axes[d]._space,X=g/U;for(;L=He(L+m,n==1?0:3),!(L>_);)if(R>1){let G=wi(He(F+R,6))%24,k=f(L).getHours()-G;k>1&&(k=-1),L-=k*i,F=(F+R)%24;let Y=v[v.length-1];He((L-Y)/m,3)*X>=.7&&v.push(L)}else v.push(L)}return v}}return[c,l,h]}var[HT,VT,GT]=iy(1),[WT,$T,XT]=iy(.001);hl(2,-53,53,[1]);function S_(n,t){return n.map(e=>e.map((i,s)=>s==0||s==8||i==null?i:t(s==1||e[8]==0?i:e[1]+i)))}function b_(n,t){return(e,i,s,r,o)=>{let a=t.find(p=>o>=p[0])||t[t.length-1],c,l,h,f,u,d;return i.map(p=>{let _=n(p),m=_.getFullYear(),g=_.getMonth(),v=_.getDate(),T=_.getHours(),S=_.getMinutes(),C=_.getSeconds(),E=m!=c&&a[2]||g!=l&&a[3]||v!=h&&a[4]||T!=f&&a[5]||S!=u&&a[6]||C!=d&&a[7]||a[1];return c=m,l=g,h=v,f=T,u=S,d=C,E(_)})}}function qT(n,t){let e=tp(t);return(i,s,r,o,a)=>s.map(c=>e(n(c)))}function Nd(n,t,e){return new Date(n,t,e)}function w_(n,t){return t(n)}var YT="{YYYY}-{MM}-{DD} {h}:{mm}{aa}";function M_(n,t){return(e,i,s,r)=>r==null?Yd:t(n(i))}function ZT(n,t){let e=n.series[t];return e.width?e.stroke(n,t):e.points.width?e.points.stroke(n,t):null}function KT(n,t){return n.series[t].fill(n,t)}var JT={show:!0,live:!0,isolate:!1,mount:gT,markers:{show:!0,width:2,stroke:ZT,fill:KT,dash:"solid"},idx:null,idxs:null,values:[]};function jT(n,t){let e=n.cursor.points,i=Li(),s=e.size(n,t);Ye(i,rl,s),Ye(i,ol,s);let r=s/-2;Ye(i,"marginLeft",r),Ye(i,"marginTop",r);let o=e.width(n,t,s);return o&&Ye(i,"borderWidth",o),i}function QT(n,t){let e=n.series[t].points;return e._fill||e._stroke}function tC(n,t){let e=n.series[t].points;return e._stroke||e._fill}function eC(n,t){return n.series[t].points.size}var Od=[0,0];function nC(n,t,e){return Od[0]=t,Od[1]=e,Od}function jh(n,t,e,i=!0){return s=>{s.button==0&&(!i||s.target==t)&&e(s)}}function Ud(n,t,e,i=!0){return s=>{(!i||s.target==t)&&e(s)}}var iC={show:!0,x:!0,y:!0,lock:!1,move:nC,points:{one:!1,show:jT,size:eC,width:0,stroke:tC,fill:QT},bind:{mousedown:jh,mouseup:jh,click:jh,dblclick:jh,mousemove:Ud,mouseleave:Ud,mouseenter:Ud},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(n,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(n,t,e,i,s)=>i-s,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},sy={show:!0,stroke:"rgba(0,0,0,0.07)",width:2},np=gn({},sy,{filter:W_}),ry=gn({},np,{size:10}),oy=gn({},sy,{show:!1}),ip='12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"',ay="bold "+ip,ly=1.5,E_={show:!0,scale:"x",stroke:qd,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:ay,side:2,grid:np,ticks:ry,border:oy,font:ip,lineGap:ly,rotate:0},sC="Value",rC="Time",A_={show:!0,scale:"x",auto:!1,sorted:1,min:ze,max:-ze,idxs:[]};function oC(n,t,e,i,s){return t.map(r=>r==null?"":jd(r))}function aC(n,t,e,i,s,r,o){let a=[],c=cr.get(s)||0;e=o?e:He(ru(e,s),c);for(let l=e;l<=i;l=He(l+s,c))a.push(Object.is(l,-0)?0:l);return a}function Vd(n,t,e,i,s,r,o){let a=[],c=n.scales[n.axes[t].scale].log,l=c==10?Ds:H_,h=wi(l(e));s=No(c,h),c==10&&(s=Cr[Yi(s,Cr)]);let f=e,u=s*c;c==10&&(u=Cr[Yi(u,Cr)]);do a.push(f),f=f+s,c==10&&!cr.has(f)&&(f=He(f,cr.get(s))),f>=u&&(s=f,u=s*c,c==10&&(u=Cr[Yi(u,Cr)]));while(f<=i);return a}function lC(n,t,e,i,s,r,o){let c=n.scales[n.axes[t].scale].asinh,l=i>c?Vd(n,t,ri(c,e),i,s):[c],h=i>=0&&e<=0?[0]:[];return(e<-c?Vd(n,t,ri(c,-i),-e,s):[c]).reverse().map(u=>-u).concat(h,l)}var cy=/./,cC=/[12357]/,hC=/[125]/,T_=/1/,Gd=(n,t,e,i)=>n.map((s,r)=>t==4&&s==0||r%i==0&&e.test(s.toExponential()[s<0?1:0])?s:null);function uC(n,t,e,i,s){let r=n.axes[e],o=r.scale,a=n.scales[o],c=n.valToPos,l=r._space,h=c(10,o),f=c(9,o)-h>=l?cy:c(7,o)-h>=l?cC:c(5,o)-h>=l?hC:T_;if(f==T_){let u=En(c(1,o)-h);if(u<l)return Gd(t.slice().reverse(),a.distr,f,Di(l/u)).reverse()}return Gd(t,a.distr,f,1)}function fC(n,t,e,i,s){let r=n.axes[e],o=r.scale,a=r._space,c=n.valToPos,l=En(c(1,o)-c(2,o));return l<a?Gd(t.slice().reverse(),3,cy,Di(a/l)).reverse():t}function dC(n,t,e,i){return i==null?Yd:t==null?"":jd(t)}var C_={show:!0,scale:"y",stroke:qd,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:ay,side:3,grid:np,ticks:ry,border:oy,font:ip,lineGap:ly,rotate:0};function pC(n,t){let e=3+(n||1)*2;return He(e*t,3)}function mC(n,t){let{scale:e,idxs:i}=n.series[0],s=n._data[0],r=n.valToPos(s[i[0]],e,!0),o=n.valToPos(s[i[1]],e,!0),a=En(o-r),c=n.series[t],l=a/(c.points.space*Ce);return i[1]-i[0]<=l}var R_={scale:null,auto:!0,sorted:0,min:ze,max:-ze},hy=(n,t,e,i,s)=>s,I_={show:!0,auto:!0,sorted:0,gaps:hy,alpha:1,facets:[gn({},R_,{scale:"x"}),gn({},R_,{scale:"y"})]},P_={scale:"y",auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:hy,alpha:1,points:{show:mC,filter:null},values:null,min:ze,max:-ze,idxs:[],path:null,clip:null};function gC(n,t,e,i,s){return e/10}var uy={time:!0,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},_C=gn({},uy,{time:!1,ori:1}),L_={};function fy(n,t){let e=L_[n];return e||(e={key:n,plots:[],sub(i){e.plots.push(i)},unsub(i){e.plots=e.plots.filter(s=>s!=i)},pub(i,s,r,o,a,c,l){for(let h=0;h<e.plots.length;h++)e.plots[h]!=s&&e.plots[h].pub(i,s,r,o,a,c,l)}},n!=null&&(L_[n]=e)),e}var Fo=1,Wd=2;function Lr(n,t,e){let i=n.mode,s=n.series[t],r=i==2?n._data[t]:n._data,o=n.scales,a=n.bbox,c=r[0],l=i==2?r[1]:r[t],h=i==2?o[s.facets[0].scale]:o[n.series[0].scale],f=i==2?o[s.facets[1].scale]:o[s.scale],u=a.left,d=a.top,p=a.width,_=a.height,m=n.valToPosH,g=n.valToPosV;return h.ori==0?e(s,c,l,h,f,m,g,u,d,p,_,lu,ko,hu,py,gy):e(s,c,l,h,f,g,m,d,u,_,p,cu,zo,op,my,_y)}function sp(n,t){let e=0,i=0,s=Ee(n.bands,Qd);for(let r=0;r<s.length;r++){let o=s[r];o.series[0]==t?e=o.dir:o.series[1]==t&&(o.dir==1?i|=1:i|=2)}return[e,i==1?-1:i==2?1:i==3?2:0]}function yC(n,t,e,i,s){let r=n.mode,o=n.series[t],a=r==2?o.facets[1].scale:o.scale,c=n.scales[a];return s==-1?c.min:s==1?c.max:c.distr==3?c.dir==1?c.min:c.max:0}function Ns(n,t,e,i,s,r){return Lr(n,t,(o,a,c,l,h,f,u,d,p,_,m)=>{let g=o.pxRound,v=l.dir*(l.ori==0?1:-1),T=l.ori==0?ko:zo,S,C;v==1?(S=e,C=i):(S=i,C=e);let E=g(f(a[S],l,_,d)),y=g(u(c[S],h,m,p)),w=g(f(a[C],l,_,d)),V=g(u(r==1?h.max:h.min,h,m,p)),N=new Path2D(s);return T(N,w,V),T(N,E,V),T(N,E,y),N})}function au(n,t,e,i,s,r){let o=null;if(n.length>0){o=new Path2D;let a=t==0?hu:op,c=e;for(let f=0;f<n.length;f++){let u=n[f];if(u[1]>u[0]){let d=u[0]-c;d>0&&a(o,c,i,d,i+r),c=u[1]}}let l=e+s-c,h=10;l>0&&a(o,c,i-h/2,l,i+r+h)}return o}function xC(n,t,e){let i=n[n.length-1];i&&i[0]==t?i[1]=e:n.push([t,e])}function rp(n,t,e,i,s,r,o){let a=[],c=n.length;for(let l=s==1?e:i;l>=e&&l<=i;l+=s)if(t[l]===null){let f=l,u=l;if(s==1)for(;++l<=i&&t[l]===null;)u=l;else for(;--l>=e&&t[l]===null;)u=l;let d=r(n[f]),p=u==f?d:r(n[u]),_=f-s;d=o<=0&&_>=0&&_<c?r(n[_]):d;let g=u+s;p=o>=0&&g>=0&&g<c?r(n[g]):p,p>=d&&a.push([d,p])}return a}function D_(n){return n==0?G_:n==1?Mn:t=>Tr(t,n)}function dy(n){let t=n==0?lu:cu,e=n==0?(s,r,o,a,c,l)=>{s.arcTo(r,o,a,c,l)}:(s,r,o,a,c,l)=>{s.arcTo(o,r,c,a,l)},i=n==0?(s,r,o,a,c)=>{s.rect(r,o,a,c)}:(s,r,o,a,c)=>{s.rect(o,r,c,a)};return(s,r,o,a,c,l=0,h=0)=>{l==0&&h==0?i(s,r,o,a,c):(l=Zi(l,a/2,c/2),h=Zi(h,a/2,c/2),t(s,r+l,o),e(s,r+a,o,r+a,o+c,l),e(s,r+a,o+c,r,o+c,h),e(s,r,o+c,r,o,h),e(s,r,o,r+a,o,l),s.closePath())}}var lu=(n,t,e)=>{n.moveTo(t,e)},cu=(n,t,e)=>{n.moveTo(e,t)},ko=(n,t,e)=>{n.lineTo(t,e)},zo=(n,t,e)=>{n.lineTo(e,t)},hu=dy(0),op=dy(1),py=(n,t,e,i,s,r)=>{n.arc(t,e,i,s,r)},my=(n,t,e,i,s,r)=>{n.arc(e,t,i,s,r)},gy=(n,t,e,i,s,r,o)=>{n.bezierCurveTo(t,e,i,s,r,o)},_y=(n,t,e,i,s,r,o)=>{n.bezierCurveTo(e,t,s,i,o,r)};function yy(n){return(t,e,i,s,r)=>Lr(t,e,(o,a,c,l,h,f,u,d,p,_,m)=>{let{pxRound:g,points:v}=o,T,S;l.ori==0?(T=lu,S=py):(T=cu,S=my);let C=He(v.width*Ce,3),E=(v.size-v.width)/2*Ce,y=He(E*2,3),w=new Path2D,V=new Path2D,{left:N,top:L,width:B,height:F}=t.bbox;hu(V,N-y,L-y,B+y*2,F+y*2);let R=U=>{if(c[U]!=null){let X=g(f(a[U],l,_,d)),G=g(u(c[U],h,m,p));T(w,X+E,G),S(w,X,G,E,0,Qh*2)}};if(r)r.forEach(R);else for(let U=i;U<=s;U++)R(U);return{stroke:C>0?w:null,fill:w,clip:V,flags:Fo|Wd}})}function xy(n){return(t,e,i,s,r,o)=>{i!=s&&(r!=i&&o!=i&&n(t,e,i),r!=s&&o!=s&&n(t,e,s),n(t,e,o))}}var vC=xy(ko),SC=xy(zo);function vy(n){let t=Ee(n?.alignGaps,0);return(e,i,s,r)=>Lr(e,i,(o,a,c,l,h,f,u,d,p,_,m)=>{[s,r]=iu(c,s,r);let g=o.pxRound,v=F=>g(f(F,l,_,d)),T=F=>g(u(F,h,m,p)),S,C;l.ori==0?(S=ko,C=vC):(S=zo,C=SC);let E=l.dir*(l.ori==0?1:-1),y={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Fo},w=y.stroke,V=!1;if(r-s>=_*4){let F=nt=>e.posToVal(nt,l.key,!0),R=null,U=null,X,G,ct,I=v(a[E==1?s:r]),k=v(a[s]),Y=v(a[r]),et=F(E==1?k+1:Y-1);for(let nt=E==1?s:r;nt>=s&&nt<=r;nt+=E){let Z=a[nt],ut=(E==1?Z<et:Z>et)?I:v(Z),dt=c[nt];ut==I?dt!=null?(G=dt,R==null?(S(w,ut,T(G)),X=R=U=G):G<R?R=G:G>U&&(U=G)):dt===null&&(V=!0):(R!=null&&C(w,I,T(R),T(U),T(X),T(G)),dt!=null?(G=dt,S(w,ut,T(G)),R=U=X=G):(R=U=null,dt===null&&(V=!0)),I=ut,et=F(I+E))}R!=null&&R!=U&&ct!=I&&C(w,I,T(R),T(U),T(X),T(G))}else for(let F=E==1?s:r;F>=s&&F<=r;F+=E){let R=c[F];R===null?V=!0:R!=null&&S(w,v(a[F]),T(R))}let[L,B]=sp(e,i);if(o.fill!=null||L!=0){let F=y.fill=new Path2D(w),R=o.fillTo(e,i,o.min,o.max,L),U=T(R),X=v(a[s]),G=v(a[r]);E==-1&&([G,X]=[X,G]),S(F,G,U),S(F,X,U)}if(!o.spanGaps){let F=[];V&&F.push(...rp(a,c,s,r,E,v,t)),y.gaps=F=o.gaps(e,i,s,r,F),y.clip=au(F,l.ori,d,p,_,m)}return B!=0&&(y.band=B==2?[Ns(e,i,s,r,w,-1),Ns(e,i,s,r,w,1)]:Ns(e,i,s,r,w,B)),y})}function bC(n){let t=Ee(n.align,1),e=Ee(n.ascDesc,!1),i=Ee(n.alignGaps,0),s=Ee(n.extend,!1);return(r,o,a,c)=>Lr(r,o,(l,h,f,u,d,p,_,m,g,v,T)=>{[a,c]=iu(f,a,c);let S=l.pxRound,{left:C,width:E}=r.bbox,y=k=>S(p(k,u,v,m)),w=k=>S(_(k,d,T,g)),V=u.ori==0?ko:zo,N={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Fo},L=N.stroke,B=u.dir*(u.ori==0?1:-1),F=w(f[B==1?a:c]),R=y(h[B==1?a:c]),U=R,X=R;s&&t==-1&&(X=C,V(L,X,F)),V(L,R,F);for(let k=B==1?a:c;k>=a&&k<=c;k+=B){let Y=f[k];if(Y==null)continue;let et=y(h[k]),nt=w(Y);t==1?V(L,et,F):V(L,U,nt),V(L,et,nt),F=nt,U=et}let G=U;s&&t==1&&(G=C+E,V(L,G,F));let[ct,I]=sp(r,o);if(l.fill!=null||ct!=0){let k=N.fill=new Path2D(L),Y=l.fillTo(r,o,l.min,l.max,ct),et=w(Y);V(k,G,et),V(k,X,et)}if(!l.spanGaps){let k=[];k.push(...rp(h,f,a,c,B,y,i));let Y=l.width*Ce/2,et=e||t==1?Y:-Y,nt=e||t==-1?-Y:Y;k.forEach(Z=>{Z[0]+=et,Z[1]+=nt}),N.gaps=k=l.gaps(r,o,a,c,k),N.clip=au(k,u.ori,m,g,v,T)}return I!=0&&(N.band=I==2?[Ns(r,o,a,c,L,-1),Ns(r,o,a,c,L,1)]:Ns(r,o,a,c,L,I)),N})}function N_(n,t,e,i,s,r,o=ze){if(n.length>1){let a=null;for(let c=0,l=1/0;c<n.length;c++)if(t[c]!==void 0){if(a!=null){let h=En(n[c]-n[a]);h<l&&(l=h,o=En(e(n[c],i,s,r)-e(n[a],i,s,r)))}a=c}}return o}function wC(n){n=n||cl;let t=Ee(n.size,[.6,ze,1]),e=n.align||0,i=n.gap||0,s=n.radius;s=s==null?[0,0]:typeof s=="number"?[s,0]:s;let r=xe(s),o=1-t[0],a=Ee(t[1],ze),c=Ee(t[2],1),l=Ee(n.disp,cl),h=Ee(n.each,d=>{}),{fill:f,stroke:u}=l;return(d,p,_,m)=>Lr(d,p,(g,v,T,S,C,E,y,w,V,N,L)=>{let B=g.pxRound,F=e,R=i*Ce,U=a*Ce,X=c*Ce,G,ct;S.ori==0?[G,ct]=r(d,p):[ct,G]=r(d,p);let I=S.dir*(S.ori==0?1:-1),k=S.ori==0?hu:op,Y=S.ori==0?h:(Rt,Jt,le,Mt,ke,Gt,Yt)=>{h(Rt,Jt,le,ke,Mt,Yt,Gt)},et=Ee(d.bands,Qd).find(Rt=>Rt.series[0]==p),nt=et!=null?et.dir:0,Z=g.fillTo(d,p,g.min,g.max,nt),at=B(y(Z,C,L,V)),ut,dt,ot,Lt=N,Zt=B(g.width*Ce),Ut=!1,ne=null,ie=null,$t=null,Re=null;f!=null&&(Zt==0||u!=null)&&(Ut=!0,ne=f.values(d,p,_,m),ie=new Map,new Set(ne).forEach(Rt=>{Rt!=null&&ie.set(Rt,new Path2D)}),Zt>0&&($t=u.values(d,p,_,m),Re=new Map,new Set($t).forEach(Rt=>{Rt!=null&&Re.set(Rt,new Path2D)})));let{x0:be,size:Ve}=l;if(be!=null&&Ve!=null){F=1,v=be.values(d,p,_,m),be.unit==2&&(v=v.map(le=>d.posToVal(w+le*N,S.key,!0)));let Rt=Ve.values(d,p,_,m);Ve.unit==2?dt=Rt[0]*N:dt=E(Rt[0],S,N,w)-E(0,S,N,w),Lt=N_(v,T,E,S,N,w,Lt),ot=Lt-dt+R}else Lt=N_(v,T,E,S,N,w,Lt),ot=Lt*o+R,dt=Lt-ot;ot<1&&(ot=0),Zt>=dt/2&&(Zt=0),ot<5&&(B=G_);let we=ot>0,cn=Lt-ot-(we?Zt:0);dt=B(Hd(cn,X,U)),ut=(F==0?dt/2:F==I?0:dt)-F*I*((F==0?R/2:0)+(we?Zt/2:0));let Se={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},yn=Ut?null:new Path2D,en=null;if(et!=null)en=d.data[et.series[1]];else{let{y0:Rt,y1:Jt}=l;Rt!=null&&Jt!=null&&(T=Jt.values(d,p,_,m),en=Rt.values(d,p,_,m))}let hn=G*dt,H=ct*dt;for(let Rt=I==1?_:m;Rt>=_&&Rt<=m;Rt+=I){let Jt=T[Rt];if(Jt==null)continue;if(en!=null){let K=en[Rt]??0;if(Jt-K==0)continue;at=y(K,C,L,V)}let le=S.distr!=2||l!=null?v[Rt]:Rt,Mt=E(le,S,N,w),ke=y(Ee(Jt,Z),C,L,V),Gt=B(Mt-ut),Yt=B(ri(ke,at)),P=B(Zi(ke,at)),b=Yt-P;if(Jt!=null){let K=Jt<0?H:hn,gt=Jt<0?hn:H;Ut?(Zt>0&&$t[Rt]!=null&&k(Re.get($t[Rt]),Gt,P+wi(Zt/2),dt,ri(0,b-Zt),K,gt),ne[Rt]!=null&&k(ie.get(ne[Rt]),Gt,P+wi(Zt/2),dt,ri(0,b-Zt),K,gt)):k(yn,Gt,P+wi(Zt/2),dt,ri(0,b-Zt),K,gt),Y(d,p,Rt,Gt-Zt/2,P,dt+Zt,b)}}return Zt>0?Se.stroke=Ut?Re:yn:Ut||(Se._fill=g.width==0?g._fill:g._stroke??g._fill,Se.width=0),Se.fill=Ut?ie:yn,Se})}function MC(n,t){let e=Ee(t?.alignGaps,0);return(i,s,r,o)=>Lr(i,s,(a,c,l,h,f,u,d,p,_,m,g)=>{[r,o]=iu(l,r,o);let v=a.pxRound,T=G=>v(u(G,h,m,p)),S=G=>v(d(G,f,g,_)),C,E,y;h.ori==0?(C=lu,y=ko,E=gy):(C=cu,y=zo,E=_y);let w=h.dir*(h.ori==0?1:-1),V=T(c[w==1?r:o]),N=V,L=[],B=[];for(let G=w==1?r:o;G>=r&&G<=o;G+=w)if(l[G]!=null){let I=c[G],k=T(I);L.push(N=k),B.push(S(l[G]))}let F={stroke:n(L,B,C,y,E,v),fill:null,clip:null,band:null,gaps:null,flags:Fo},R=F.stroke,[U,X]=sp(i,s);if(a.fill!=null||U!=0){let G=F.fill=new Path2D(R),ct=a.fillTo(i,s,a.min,a.max,U),I=S(ct);y(G,N,I),y(G,V,I)}if(!a.spanGaps){let G=[];G.push(...rp(c,l,r,o,w,T,e)),F.gaps=G=a.gaps(i,s,r,o,G),F.clip=au(G,h.ori,p,_,m,g)}return X!=0&&(F.band=X==2?[Ns(i,s,r,o,R,-1),Ns(i,s,r,o,R,1)]:Ns(i,s,r,o,R,X)),F})}function EC(n){return MC(AC,n)}function AC(n,t,e,i,s,r){let o=n.length;if(o<2)return null;let a=new Path2D;if(e(a,n[0],t[0]),o==2)i(a,n[1],t[1]);else{let c=Array(o),l=Array(o-1),h=Array(o-1),f=Array(o-1);for(let u=0;u<o-1;u++)h[u]=t[u+1]-t[u],f[u]=n[u+1]-n[u],l[u]=h[u]/f[u];c[0]=l[0];for(let u=1;u<o-1;u++)l[u]===0||l[u-1]===0||l[u-1]>0!=l[u]>0?c[u]=0:(c[u]=3*(f[u-1]+f[u])/((2*f[u]+f[u-1])/l[u-1]+(f[u]+2*f[u-1])/l[u]),isFinite(c[u])||(c[u]=0));c[o-1]=l[o-2];for(let u=0;u<o-1;u++)s(a,n[u]+f[u]/3,t[u]+c[u]*f[u]/3,n[u+1]-f[u]/3,t[u+1]-c[u+1]*f[u]/3,n[u+1],t[u+1])}return a}var $d=new Set;function O_(){for(let n of $d)n.syncRect(!0)}Bo&&(Ir(oT,Do,O_),Ir(aT,Do,O_,!0),Ir(tu,Do,()=>{An.pxRatio=Ce}));var TC=vy(),CC=yy();function U_(n,t,e,i){return(i?[n[0],n[1]].concat(n.slice(2)):[n[0]].concat(n.slice(1))).map((r,o)=>Xd(r,o,t,e))}function RC(n,t){return n.map((e,i)=>i==0?{}:gn({},t,e))}function Xd(n,t,e,i){return gn({},t==0?e:i,n)}function Sy(n,t,e){return t==null?Oo:[t,e]}var IC=Sy;function PC(n,t,e){return t==null?Oo:eu(t,e,Jd,!0)}function by(n,t,e,i){return t==null?Oo:su(t,e,n.scales[i].log,!1)}var LC=by;function wy(n,t,e,i){return t==null?Oo:Kd(t,e,n.scales[i].log,!1)}var DC=wy;function NC(n,t,e,i,s){let r=ri(p_(n),p_(t)),o=t-n,a=Yi(s/i*o,e);do{let c=e[a],l=i*c/o;if(l>=s&&r+(c<5?cr.get(c):0)<=17)return[c,l]}while(++a<e.length);return[0,0]}function F_(n){let t,e;return n=n.replace(/(\d+)px/,(i,s)=>(t=Mn((e=+s)*Ce))+"px"),[n,t,e]}function OC(n){n.show&&[n.font,n.labelFont].forEach(t=>{let e=He(t[2]*Ce,1);t[0]=t[0].replace(/[0-9.]+px/,e+"px"),t[1]=e})}function An(n,t,e){let i={mode:Ee(n.mode,1)},s=i.mode;function r(x,M,D,O){let q=M.valToPct(x);return O+D*(M.dir==-1?1-q:q)}function o(x,M,D,O){let q=M.valToPct(x);return O+D*(M.dir==-1?q:1-q)}function a(x,M,D,O){return M.ori==0?r(x,M,D,O):o(x,M,D,O)}i.valToPosH=r,i.valToPosV=o;let c=!1;i.status=0;let l=i.root=Li(V1);if(n.id!=null&&(l.id=n.id),bi(l,n.class),n.title){let x=Li($1,l);x.textContent=n.title}let h=qi("canvas"),f=i.ctx=h.getContext("2d"),u=Li(X1,l);Ir("click",u,x=>{x.target===p&&(We!=kr||Ke!=zr)&&Un.click(i,x)},!0);let d=i.under=Li(q1,u);u.appendChild(h);let p=i.over=Li(Y1,u);n=Uo(n);let _=+Ee(n.pxAlign,1),m=D_(_);(n.plugins||[]).forEach(x=>{x.opts&&(n=x.opts(i,n)||n)});let g=n.ms||.001,v=i.series=s==1?U_(n.series||[],A_,P_,!1):RC(n.series||[null],I_),T=i.axes=U_(n.axes||[],E_,C_,!0),S=i.scales={},C=i.bands=n.bands||[];C.forEach(x=>{x.fill=xe(x.fill||null),x.dir=Ee(x.dir,-1)});let E=s==2?v[1].facets[0].scale:v[0].scale,y={axes:_s,series:pe},w=(n.drawOrder||["axes","series"]).map(x=>y[x]);function V(x){let M=x.distr==3?D=>Ds(D>0?D:x.clamp(i,D,x.min,x.max,x.key)):x.distr==4?D=>Dd(D,x.asinh):x.distr==100?D=>x.fwd(D):D=>D;return D=>{let O=M(D),{_min:q,_max:tt}=x,pt=tt-q;return(O-q)/pt}}function N(x){let M=S[x];if(M==null){let D=(n.scales||cl)[x]||cl;if(D.from!=null){N(D.from);let O=gn({},S[D.from],D,{key:x});O.valToPct=V(O),S[x]=O}else{M=S[x]=gn({},x==E?uy:_C,D),M.key=x;let O=M.time,q=M.range,tt=lr(q);if((x!=E||s==2&&!O)&&(tt&&(q[0]==null||q[1]==null)&&(q={min:q[0]==null?u_:{mode:1,hard:q[0],soft:q[0]},max:q[1]==null?u_:{mode:1,hard:q[1],soft:q[1]}},tt=!1),!tt&&ou(q))){let pt=q;q=(_t,bt,Nt)=>bt==null?Oo:eu(bt,Nt,pt)}M.range=xe(q||(O?IC:x==E?M.distr==3?LC:M.distr==4?DC:Sy:M.distr==3?by:M.distr==4?wy:PC)),M.auto=xe(tt?!1:M.auto),M.clamp=xe(M.clamp||gC),M._min=M._max=null,M.valToPct=V(M)}}}N("x"),N("y"),s==1&&v.forEach(x=>{N(x.scale)}),T.forEach(x=>{N(x.scale)});for(let x in n.scales)N(x);let L=S[E],B=L.distr,F,R;L.ori==0?(bi(l,G1),F=r,R=o):(bi(l,W1),F=o,R=r);let U={};for(let x in S){let M=S[x];(M.min!=null||M.max!=null)&&(U[x]={min:M.min,max:M.max},M.min=M.max=null)}let X=n.tzDate||(x=>new Date(Mn(x/g))),G=n.fmtDate||tp,ct=g==1?GT(X):XT(X),I=b_(X,S_(g==1?VT:$T,G)),k=M_(X,w_(YT,G)),Y=[],et=i.legend=gn({},JT,n.legend),nt=i.cursor=gn({},iC,{drag:{y:s==2}},n.cursor),Z=et.show,at=nt.show,ut=et.markers;et.idxs=Y,ut.width=xe(ut.width),ut.dash=xe(ut.dash),ut.stroke=xe(ut.stroke),ut.fill=xe(ut.fill);let dt,ot,Lt,Zt=[],Ut=[],ne,ie=!1,$t={};if(et.live){let x=v[1]?v[1].values:null;ie=x!=null,ne=ie?x(i,1,0):{_:0};for(let M in ne)$t[M]=Yd}if(Z)if(dt=qi("table",tT,l),Lt=qi("tbody",null,dt),et.mount(i,dt),ie){ot=qi("thead",null,dt,Lt);let x=qi("tr",null,ot);qi("th",null,x);for(var Re in ne)qi("th",j0,x).textContent=Re}else bi(dt,nT),et.live&&bi(dt,eT);let be={show:!0},Ve={show:!1};function we(x,M){if(M==0&&(ie||!et.live||s==2))return Oo;let D=[],O=qi("tr",iT,Lt,Lt.childNodes[M]);bi(O,x.class),x.show||bi(O,Rr);let q=qi("th",null,O);if(ut.show){let _t=Li(sT,q);if(M>0){let bt=ut.width(i,M);bt&&(_t.style.border=bt+"px "+ut.dash(i,M)+" "+ut.stroke(i,M)),_t.style.background=ut.fill(i,M)}}let tt=Li(j0,q);x.label instanceof HTMLElement?tt.appendChild(x.label):tt.textContent=x.label,M>0&&(ut.show||(tt.style.color=x.width>0?ut.stroke(i,M):ut.fill(i,M)),Se("click",q,_t=>{if(nt._lock)return;te(_t);let bt=v.indexOf(x);if((_t.ctrlKey||_t.metaKey)!=et.isolate){let Nt=v.some((Ot,kt)=>kt>0&&kt!=bt&&Ot.show);v.forEach((Ot,kt)=>{kt>0&&ts(kt,Nt?kt==bt?be:Ve:be,!0,pn.setSeries)})}else ts(bt,{show:!x.show},!0,pn.setSeries)},!1),ee&&Se(n_,q,_t=>{nt._lock||(te(_t),ts(v.indexOf(x),Vr,!0,pn.setSeries))},!1));for(var pt in ne){let _t=qi("td",rT,O);_t.textContent="--",D.push(_t)}return[O,D]}let cn=new Map;function Se(x,M,D,O=!0){let q=cn.get(M)||{},tt=nt.bind[x](i,M,D,O);tt&&(Ir(x,M,q[x]=tt),cn.set(M,q))}function yn(x,M,D){let O=cn.get(M)||{};for(let q in O)(x==null||q==x)&&(zd(q,M,O[q]),delete O[q]);x==null&&cn.delete(M)}let en=0,hn=0,H=0,Rt=0,Jt=0,le=0,Mt=Jt,ke=le,Gt=H,Yt=Rt,P=0,b=0,K=0,gt=0;i.bbox={};let ft=!1,vt=!1,St=!1,st=!1,lt=!1,yt=!1;function z(x,M,D){(D||x!=i.width||M!=i.height)&&ht(x,M),he(!1),St=!0,vt=!0,Vn()}function ht(x,M){i.width=en=H=x,i.height=hn=Rt=M,Jt=le=0,wt(),Wt();let D=i.bbox;P=D.left=Tr(Jt*Ce,.5),b=D.top=Tr(le*Ce,.5),K=D.width=Tr(H*Ce,.5),gt=D.height=Tr(Rt*Ce,.5)}let rt=3;function Et(){let x=!1,M=0;for(;!x;){M++;let D=Ur(M),O=Qi(M);x=M==rt||D&&O,x||(ht(i.width,i.height),vt=!0)}}function xt({width:x,height:M}){z(x,M)}i.setSize=xt;function wt(){let x=!1,M=!1,D=!1,O=!1;T.forEach((q,tt)=>{if(q.show&&q._show){let{side:pt,_size:_t}=q,bt=pt%2,Nt=q.label!=null?q.labelSize:0,Ot=_t+Nt;Ot>0&&(bt?(H-=Ot,pt==3?(Jt+=Ot,O=!0):D=!0):(Rt-=Ot,pt==0?(le+=Ot,x=!0):M=!0))}}),Ji[0]=x,Ji[1]=D,Ji[2]=M,Ji[3]=O,H-=Oi[1]+Oi[3],Jt+=Oi[3],Rt-=Oi[2]+Oi[0],le+=Oi[0]}function Wt(){let x=Jt+H,M=le+Rt,D=Jt,O=le;function q(tt,pt){switch(tt){case 1:return x+=pt,x-pt;case 2:return M+=pt,M-pt;case 3:return D-=pt,D+pt;case 0:return O-=pt,O+pt}}T.forEach((tt,pt)=>{if(tt.show&&tt._show){let _t=tt.side;tt._pos=q(_t,tt._size),tt.label!=null&&(tt._lpos=q(_t,tt.labelSize))}})}if(nt.dataIdx==null){let x=nt.hover,M=x.skip=new Set(x.skip??[]);M.add(void 0);let D=x.prox=xe(x.prox),O=x.bias??=0;nt.dataIdx=(q,tt,pt,_t)=>{if(tt==0)return pt;let bt=pt,Nt=D(q,tt,pt,_t)??ze,Ot=Nt>=0&&Nt<ze,kt=L.ori==0?H:Rt,ae=nt.left,Ae=t[0],Me=t[tt];if(M.has(Me[pt])){bt=null;let ge=null,Qt=null,Xt;if(O==0||O==-1)for(Xt=pt;ge==null&&Xt-- >0;)M.has(Me[Xt])||(ge=Xt);if(O==0||O==1)for(Xt=pt;Qt==null&&Xt++<Me.length;)M.has(Me[Xt])||(Qt=Xt);if(ge!=null||Qt!=null)if(Ot){let Xe=ge==null?-1/0:F(Ae[ge],L,kt,0),rn=Qt==null?1/0:F(Ae[Qt],L,kt,0),In=ae-Xe,Fe=rn-ae;In<=Fe?In<=Nt&&(bt=ge):Fe<=Nt&&(bt=Qt)}else bt=Qt==null?ge:ge==null?Qt:pt-ge<=Qt-pt?ge:Qt}else Ot&&En(ae-F(Ae[pt],L,kt,0))>Nt&&(bt=null);return bt}}let te=x=>{nt.event=x};nt.idxs=Y,nt._lock=!1;let mt=nt.points;mt.show=xe(mt.show),mt.size=xe(mt.size),mt.stroke=xe(mt.stroke),mt.width=xe(mt.width),mt.fill=xe(mt.fill);let zt=i.focus=gn({},n.focus||{alpha:.3},nt.focus),ee=zt.prox>=0,Ct=ee&&mt.one,ce=[],Ge=[],Zn=[];function $o(x,M){let D=mt.show(i,M);if(D instanceof HTMLElement)return bi(D,Q1),bi(D,x.class),fs(D,-10,-10,H,Rt),p.insertBefore(D,ce[M]),D}function Dr(x,M){if(s==1||M>0){let D=s==1&&S[x.scale].time,O=x.value;x.value=D?__(O)?M_(X,w_(O,G)):O||k:O||dC,x.label=x.label||(D?rC:sC)}if(Ct||M>0){x.width=x.width==null?1:x.width,x.paths=x.paths||TC||_T,x.fillTo=xe(x.fillTo||yC),x.pxAlign=+Ee(x.pxAlign,_),x.pxRound=D_(x.pxAlign),x.stroke=xe(x.stroke||null),x.fill=xe(x.fill||null),x._stroke=x._fill=x._paths=x._focus=null;let D=pC(ri(1,x.width),1),O=x.points=gn({},{size:D,width:ri(1,D*.2),stroke:x.stroke,space:D*2,paths:CC,_stroke:null,_fill:null},x.points);O.show=xe(O.show),O.filter=xe(O.filter),O.fill=xe(O.fill),O.stroke=xe(O.stroke),O.paths=xe(O.paths),O.pxAlign=x.pxAlign}if(Z){let D=we(x,M);Zt.splice(M,0,D[0]),Ut.splice(M,0,D[1]),et.values.push(null)}if(at){Y.splice(M,0,null);let D=null;Ct?M==0&&(D=$o(x,M)):M>0&&(D=$o(x,M)),ce.splice(M,0,D),Ge.splice(M,0,0),Zn.splice(M,0,0)}Rn("addSeries",M)}function Iu(x,M){M=M??v.length,x=s==1?Xd(x,M,A_,P_):Xd(x,M,{},I_),v.splice(M,0,x),Dr(v[M],M)}i.addSeries=Iu;function ml(x){if(v.splice(x,1),Z){et.values.splice(x,1),Ut.splice(x,1);let M=Zt.splice(x,1)[0];yn(null,M.firstChild),M.remove()}at&&(Y.splice(x,1),ce.splice(x,1)[0].remove(),Ge.splice(x,1),Zn.splice(x,1)),Rn("delSeries",x)}i.delSeries=ml;let Ji=[!1,!1,!1,!1];function ps(x,M){if(x._show=x.show,x.show){let D=x.side%2,O=S[x.scale];O==null&&(x.scale=D?v[1].scale:E,O=S[x.scale]);let q=O.time;x.size=xe(x.size),x.space=xe(x.space),x.rotate=xe(x.rotate),lr(x.incrs)&&x.incrs.forEach(pt=>{!cr.has(pt)&&cr.set(pt,X_(pt))}),x.incrs=xe(x.incrs||(O.distr==2?kT:q?g==1?HT:WT:Cr)),x.splits=xe(x.splits||(q&&O.distr==1?ct:O.distr==3?Vd:O.distr==4?lC:aC)),x.stroke=xe(x.stroke),x.grid.stroke=xe(x.grid.stroke),x.ticks.stroke=xe(x.ticks.stroke),x.border.stroke=xe(x.border.stroke);let tt=x.values;x.values=lr(tt)&&!lr(tt[0])?xe(tt):q?lr(tt)?b_(X,S_(tt,G)):__(tt)?qT(X,tt):tt||I:tt||oC,x.filter=xe(x.filter||(O.distr>=3&&O.log==10?uC:O.distr==3&&O.log==2?fC:W_)),x.font=F_(x.font),x.labelFont=F_(x.labelFont),x._size=x.size(i,null,M,0),x._space=x._rotate=x._incrs=x._found=x._splits=x._values=null,x._size>0&&(Ji[M]=!0,x._el=Li(Z1,u))}}function ms(x,M,D,O){let[q,tt,pt,_t]=D,bt=M%2,Nt=0;return bt==0&&(_t||tt)&&(Nt=M==0&&!q||M==2&&!pt?Mn(E_.size/3):0),bt==1&&(q||pt)&&(Nt=M==1&&!tt||M==3&&!_t?Mn(C_.size/2):0),Nt}let Xo=i.padding=(n.padding||[ms,ms,ms,ms]).map(x=>xe(Ee(x,ms))),Oi=i._padding=Xo.map((x,M)=>x(i,M,Ji,0)),nn,an=null,ln=null,ji=s==1?v[0].idxs:null,fi=null,Us=!1;function qo(x,M){if(t=x??[],i.data=i._data=t,s==2){nn=0;for(let D=1;D<v.length;D++)nn+=t[D][0].length}else{t.length==0&&(i.data=i._data=t=[[]]),fi=t[0],nn=fi.length;let D=t;if(B==2){D=t.slice();let O=D[0]=Array(nn);for(let q=0;q<nn;q++)O[q]=q}i._data=t=D}if(he(!0),Rn("setData"),B==2&&(St=!0),M!==!1){let D=L;D.auto(i,Us)?Yo():ks(E,D.min,D.max),st=st||nt.left>=0,yt=!0,Vn()}}i.setData=qo;function Yo(){Us=!0;let x,M;s==1&&(nn>0?(an=ji[0]=0,ln=ji[1]=nn-1,x=t[0][an],M=t[0][ln],B==2?(x=an,M=ln):x==M&&(B==3?[x,M]=su(x,x,L.log,!1):B==4?[x,M]=Kd(x,x,L.log,!1):L.time?M=x+Mn(86400/g):[x,M]=eu(x,M,Jd,!0))):(an=ji[0]=x=null,ln=ji[1]=M=null)),ks(E,x,M)}let Nr,Fs,Or,A,W,it,j,Q,At,It;function Tt(x,M,D,O,q,tt){x??=t_,D??=Qd,O??="butt",q??=t_,tt??="round",x!=Nr&&(f.strokeStyle=Nr=x),q!=Fs&&(f.fillStyle=Fs=q),M!=Or&&(f.lineWidth=Or=M),tt!=W&&(f.lineJoin=W=tt),O!=it&&(f.lineCap=it=O),D!=A&&f.setLineDash(A=D)}function Pt(x,M,D,O){M!=Fs&&(f.fillStyle=Fs=M),x!=j&&(f.font=j=x),D!=Q&&(f.textAlign=Q=D),O!=At&&(f.textBaseline=At=O)}function Vt(x,M,D,O,q=0){if(O.length>0&&x.auto(i,Us)&&(M==null||M.min==null)){let tt=Ee(an,0),pt=Ee(ln,O.length-1),_t=D.min==null?uT(O,tt,pt,q,x.distr==3):[D.min,D.max];x.min=Zi(x.min,D.min=_t[0]),x.max=ri(x.max,D.max=_t[1])}}let se={min:null,max:null};function de(){for(let O in S){let q=S[O];U[O]==null&&(q.min==null||U[E]!=null&&q.auto(i,Us))&&(U[O]=se)}for(let O in S){let q=S[O];U[O]==null&&q.from!=null&&U[q.from]!=null&&(U[O]=se)}U[E]!=null&&he(!0);let x={};for(let O in U){let q=U[O];if(q!=null){let tt=x[O]=Uo(S[O],vT);if(q.min!=null)gn(tt,q);else if(O!=E||s==2)if(nn==0&&tt.from==null){let pt=tt.range(i,null,null,O);tt.min=pt[0],tt.max=pt[1]}else tt.min=ze,tt.max=-ze}}if(nn>0){v.forEach((O,q)=>{if(s==1){let tt=O.scale,pt=U[tt];if(pt==null)return;let _t=x[tt];if(q==0){let bt=_t.range(i,_t.min,_t.max,tt);_t.min=bt[0],_t.max=bt[1],an=Yi(_t.min,t[0]),ln=Yi(_t.max,t[0]),ln-an>1&&(t[0][an]<_t.min&&an++,t[0][ln]>_t.max&&ln--),O.min=fi[an],O.max=fi[ln]}else O.show&&O.auto&&Vt(_t,pt,O,t[q],O.sorted);O.idxs[0]=an,O.idxs[1]=ln}else if(q>0&&O.show&&O.auto){let[tt,pt]=O.facets,_t=tt.scale,bt=pt.scale,[Nt,Ot]=t[q],kt=x[_t],ae=x[bt];kt!=null&&Vt(kt,U[_t],tt,Nt,tt.sorted),ae!=null&&Vt(ae,U[bt],pt,Ot,pt.sorted),O.min=pt.min,O.max=pt.max}});for(let O in x){let q=x[O],tt=U[O];if(q.from==null&&(tt==null||tt.min==null)){let pt=q.range(i,q.min==ze?null:q.min,q.max==-ze?null:q.max,O);q.min=pt[0],q.max=pt[1]}}}for(let O in x){let q=x[O];if(q.from!=null){let tt=x[q.from];if(tt.min==null)q.min=q.max=null;else{let pt=q.range(i,tt.min,tt.max,O);q.min=pt[0],q.max=pt[1]}}}let M={},D=!1;for(let O in x){let q=x[O],tt=S[O];if(tt.min!=q.min||tt.max!=q.max){tt.min=q.min,tt.max=q.max;let pt=tt.distr;tt._min=pt==3?Ds(tt.min):pt==4?Dd(tt.min,tt.asinh):pt==100?tt.fwd(tt.min):tt.min,tt._max=pt==3?Ds(tt.max):pt==4?Dd(tt.max,tt.asinh):pt==100?tt.fwd(tt.max):tt.max,M[O]=D=!0}}if(D){v.forEach((O,q)=>{s==2?q>0&&M.y&&(O._paths=null):M[O.scale]&&(O._paths=null)});for(let O in M)St=!0,Rn("setScale",O);at&&nt.left>=0&&(st=yt=!0)}for(let O in U)U[O]=null}function Ht(x){let M=Hd(an-1,0,nn-1),D=Hd(ln+1,0,nn-1);for(;x[M]==null&&M>0;)M--;for(;x[D]==null&&D<nn-1;)D++;return[M,D]}function pe(){if(nn>0){let x=v.some(M=>M._focus)&&It!=zt.alpha;x&&(f.globalAlpha=It=zt.alpha),v.forEach((M,D)=>{if(D>0&&M.show&&(je(D,!1),je(D,!0),M._paths==null)){let O=It;It!=M.alpha&&(f.globalAlpha=It=M.alpha);let q=s==2?[0,t[D][0].length-1]:Ht(t[D]);M._paths=M.paths(i,D,q[0],q[1]),It!=O&&(f.globalAlpha=It=O)}}),v.forEach((M,D)=>{if(D>0&&M.show){let O=It;It!=M.alpha&&(f.globalAlpha=It=M.alpha),M._paths!=null&&De(D,!1);{let q=M._paths!=null?M._paths.gaps:null,tt=M.points.show(i,D,an,ln,q),pt=M.points.filter(i,D,tt,q);(tt||pt)&&(M.points._paths=M.points.paths(i,D,an,ln,pt),De(D,!0))}It!=O&&(f.globalAlpha=It=O),Rn("drawSeries",D)}}),x&&(f.globalAlpha=It=1)}}function je(x,M){let D=M?v[x].points:v[x];D._stroke=D.stroke(i,x),D._fill=D.fill(i,x)}function De(x,M){let D=M?v[x].points:v[x],{stroke:O,fill:q,clip:tt,flags:pt,_stroke:_t=D._stroke,_fill:bt=D._fill,_width:Nt=D.width}=D._paths;Nt=He(Nt*Ce,3);let Ot=null,kt=Nt%2/2;M&&bt==null&&(bt=Nt>0?"#fff":_t);let ae=D.pxAlign==1&&kt>0;if(ae&&f.translate(kt,kt),!M){let Ae=P-Nt/2,Me=b-Nt/2,ge=K+Nt,Qt=gt+Nt;Ot=new Path2D,Ot.rect(Ae,Me,ge,Qt)}M?Ft(_t,Nt,D.dash,D.cap,bt,O,q,pt,tt):Ne(x,_t,Nt,D.dash,D.cap,bt,O,q,pt,Ot,tt),ae&&f.translate(-kt,-kt)}function Ne(x,M,D,O,q,tt,pt,_t,bt,Nt,Ot){let kt=!1;bt!=0&&C.forEach((ae,Ae)=>{if(ae.series[0]==x){let Me=v[ae.series[1]],ge=t[ae.series[1]],Qt=(Me._paths||cl).band;lr(Qt)&&(Qt=ae.dir==1?Qt[0]:Qt[1]);let Xt,Xe=null;Me.show&&Qt&&dT(ge,an,ln)?(Xe=ae.fill(i,Ae)||tt,Xt=Me._paths.clip):Qt=null,Ft(M,D,O,q,Xe,pt,_t,bt,Nt,Ot,Xt,Qt),kt=!0}}),kt||Ft(M,D,O,q,tt,pt,_t,bt,Nt,Ot)}let xn=Fo|Wd;function Ft(x,M,D,O,q,tt,pt,_t,bt,Nt,Ot,kt){Tt(x,M,D,O,q),(bt||Nt||kt)&&(f.save(),bt&&f.clip(bt),Nt&&f.clip(Nt)),kt?(_t&xn)==xn?(f.clip(kt),Ot&&f.clip(Ot),_e(q,pt),un(x,tt,M)):_t&Wd?(_e(q,pt),f.clip(kt),un(x,tt,M)):_t&Fo&&(f.save(),f.clip(kt),Ot&&f.clip(Ot),_e(q,pt),f.restore(),un(x,tt,M)):(_e(q,pt),un(x,tt,M)),(bt||Nt||kt)&&f.restore()}function un(x,M,D){D>0&&(M instanceof Map?M.forEach((O,q)=>{f.strokeStyle=Nr=q,f.stroke(O)}):M!=null&&x&&f.stroke(M))}function _e(x,M){M instanceof Map?M.forEach((D,O)=>{f.fillStyle=Fs=O,f.fill(D)}):M!=null&&x&&f.fill(M)}function gs(x,M,D,O){let q=T[x],tt;if(O<=0)tt=[0,0];else{let pt=q._space=q.space(i,x,M,D,O),_t=q._incrs=q.incrs(i,x,M,D,O,pt);tt=NC(M,D,_t,O,pt)}return q._found=tt}function fn(x,M,D,O,q,tt,pt,_t,bt,Nt){let Ot=pt%2/2;_==1&&f.translate(Ot,Ot),Tt(_t,pt,bt,Nt,_t),f.beginPath();let kt,ae,Ae,Me,ge=q+(O==0||O==3?-tt:tt);D==0?(ae=q,Me=ge):(kt=q,Ae=ge);for(let Qt=0;Qt<x.length;Qt++)M[Qt]!=null&&(D==0?kt=Ae=x[Qt]:ae=Me=x[Qt],f.moveTo(kt,ae),f.lineTo(Ae,Me));f.stroke(),_==1&&f.translate(-Ot,-Ot)}function Ur(x){let M=!0;return T.forEach((D,O)=>{if(!D.show)return;let q=S[D.scale];if(q.min==null){D._show&&(M=!1,D._show=!1,he(!1));return}else D._show||(M=!1,D._show=!0,he(!1));let tt=D.side,pt=tt%2,{min:_t,max:bt}=q,[Nt,Ot]=gs(O,_t,bt,pt==0?H:Rt);if(Ot==0)return;let kt=q.distr==2,ae=D._splits=D.splits(i,O,_t,bt,Nt,Ot,kt),Ae=q.distr==2?ae.map(Xt=>fi[Xt]):ae,Me=q.distr==2?fi[ae[1]]-fi[ae[0]]:Nt,ge=D._values=D.values(i,D.filter(i,Ae,O,Ot,Me),O,Ot,Me);D._rotate=tt==2?D.rotate(i,ge,O,Ot):0;let Qt=D._size;D._size=Di(D.size(i,ge,O,x)),Qt!=null&&D._size!=Qt&&(M=!1)}),M}function Qi(x){let M=!0;return Xo.forEach((D,O)=>{let q=D(i,O,Ji,x);q!=Oi[O]&&(M=!1),Oi[O]=q}),M}function _s(){for(let x=0;x<T.length;x++){let M=T[x];if(!M.show||!M._show)continue;let D=M.side,O=D%2,q,tt,pt=M.stroke(i,x),_t=D==0||D==3?-1:1,[bt,Nt]=M._found;if(M.label!=null){let jn=M.labelGap*_t,mi=Mn((M._lpos+jn)*Ce);Pt(M.labelFont[0],pt,"center",D==2?"top":Q0),f.save(),O==1?(q=tt=0,f.translate(mi,Mn(b+gt/2)),f.rotate((D==3?-Qh:Qh)/2)):(q=Mn(P+K/2),tt=mi);let mr=V_(M.label)?M.label(i,x,bt,Nt):M.label;f.fillText(mr,q,tt),f.restore()}if(Nt==0)continue;let Ot=S[M.scale],kt=O==0?K:gt,ae=O==0?P:b,Ae=M._splits,Me=Ot.distr==2?Ae.map(jn=>fi[jn]):Ae,ge=Ot.distr==2?fi[Ae[1]]-fi[Ae[0]]:bt,Qt=M.ticks,Xt=M.border,Xe=Qt.show?Qt.size:0,rn=Mn(Xe*Ce),In=Mn((M.alignTo==2?M._size-Xe-M.gap:M.gap)*Ce),Fe=M._rotate*-Qh/180,on=m(M._pos*Ce),di=(rn+In)*_t,Jn=on+di;tt=O==0?Jn:0,q=O==1?Jn:0;let Ti=M.font[0],Ui=M.align==1?Po:M.align==2?Id:Fe>0?Po:Fe<0?Id:O==0?"center":D==3?Id:Po,ns=Fe||O==1?"middle":D==2?"top":Q0;Pt(Ti,pt,Ui,ns);let pi=M.font[1]*M.lineGap,Ci=Ae.map(jn=>m(a(jn,Ot,kt,ae))),Fi=M._values;for(let jn=0;jn<Fi.length;jn++){let mi=Fi[jn];if(mi!=null){O==0?q=Ci[jn]:tt=Ci[jn],mi=""+mi;let mr=mi.indexOf(`
`)==-1?[mi]:mi.split(/\n/gm);for(let Qn=0;Qn<mr.length;Qn++){let Pp=mr[Qn];Fe?(f.save(),f.translate(q,tt+Qn*pi),f.rotate(Fe),f.fillText(Pp,0,0),f.restore()):f.fillText(Pp,q,tt+Qn*pi)}}}Qt.show&&fn(Ci,Qt.filter(i,Me,x,Nt,ge),O,D,on,rn,He(Qt.width*Ce,3),Qt.stroke(i,x),Qt.dash,Qt.cap);let is=M.grid;is.show&&fn(Ci,is.filter(i,Me,x,Nt,ge),O,O==0?2:1,O==0?b:P,O==0?gt:K,He(is.width*Ce,3),is.stroke(i,x),is.dash,is.cap),Xt.show&&fn([on],[1],O==0?1:0,O==0?1:2,O==1?b:P,O==1?gt:K,He(Xt.width*Ce,3),Xt.stroke(i,x),Xt.dash,Xt.cap)}Rn("drawAxes")}function he(x){v.forEach((M,D)=>{D>0&&(M._paths=null,x&&(s==1?(M.min=null,M.max=null):M.facets.forEach(O=>{O.min=null,O.max=null})))})}let sn=!1,Kn=!1,Oe=[];function dn(){Kn=!1;for(let x=0;x<Oe.length;x++)Rn(...Oe[x]);Oe.length=0}function Vn(){sn||(TT(dp),sn=!0)}function gl(x,M=!1){sn=!0,Kn=M,x(i),dp(),M&&Oe.length>0&&queueMicrotask(dn)}i.batch=gl;function dp(){if(ft&&(de(),ft=!1),St&&(Et(),St=!1),vt){if(Ye(d,Po,Jt),Ye(d,"top",le),Ye(d,rl,H),Ye(d,ol,Rt),Ye(p,Po,Jt),Ye(p,"top",le),Ye(p,rl,H),Ye(p,ol,Rt),Ye(u,rl,en),Ye(u,ol,hn),h.width=Mn(en*Ce),h.height=Mn(hn*Ce),T.forEach(({_el:x,_show:M,_size:D,_pos:O,side:q})=>{if(x!=null)if(M){let tt=q===3||q===0?D:0,pt=q%2==1;Ye(x,pt?"left":"top",O-tt),Ye(x,pt?"width":"height",D),Ye(x,pt?"top":"left",pt?le:Jt),Ye(x,pt?"height":"width",pt?Rt:H),kd(x,Rr)}else bi(x,Rr)}),Nr=Fs=Or=W=it=j=Q=At=A=null,It=1,Jo(!0),Jt!=Mt||le!=ke||H!=Gt||Rt!=Yt){he(!1);let x=H/Gt,M=Rt/Yt;if(at&&!st&&nt.left>=0){nt.left*=x,nt.top*=M,Fr&&fs(Fr,Mn(nt.left),0,H,Rt),Br&&fs(Br,0,Mn(nt.top),H,Rt);for(let D=0;D<ce.length;D++){let O=ce[D];O!=null&&(Ge[D]*=x,Zn[D]*=M,fs(O,Di(Ge[D]),Di(Zn[D]),H,Rt))}}if($e.show&&!lt&&$e.left>=0&&$e.width>0){$e.left*=x,$e.width*=x,$e.top*=M,$e.height*=M;for(let D in Uu)Ye(Hr,D,$e[D])}Mt=Jt,ke=le,Gt=H,Yt=Rt}Rn("setSize"),vt=!1}en>0&&hn>0&&(f.clearRect(0,0,h.width,h.height),Rn("drawClear"),w.forEach(x=>x()),Rn("draw")),$e.show&&lt&&(_l($e),lt=!1),at&&st&&(pr(null,!0,!1),st=!1),et.show&&et.live&&yt&&(Nu(),yt=!1),c||(c=!0,i.status=1,Rn("ready")),Us=!1,sn=!1}i.redraw=(x,M)=>{St=M||!1,x!==!1?ks(E,L.min,L.max):Vn()};function Pu(x,M){let D=S[x];if(D.from==null){if(nn==0){let O=D.range(i,M.min,M.max,x);M.min=O[0],M.max=O[1]}if(M.min>M.max){let O=M.min;M.min=M.max,M.max=O}if(nn>1&&M.min!=null&&M.max!=null&&M.max-M.min<1e-16)return;x==E&&D.distr==2&&nn>0&&(M.min=Yi(M.min,t[0]),M.max=Yi(M.max,t[0]),M.min==M.max&&M.max++),U[x]=M,ft=!0,Vn()}}i.setScale=Pu;let Lu,Du,Fr,Br,pp,mp,kr,zr,gp,_p,We,Ke,Bs=!1,Un=nt.drag,Tn=Un.x,Cn=Un.y;at&&(nt.x&&(Lu=Li(J1,p)),nt.y&&(Du=Li(j1,p)),L.ori==0?(Fr=Lu,Br=Du):(Fr=Du,Br=Lu),We=nt.left,Ke=nt.top);let $e=i.select=gn({show:!0,over:!0,left:0,width:0,top:0,height:0},n.select),Hr=$e.show?Li(K1,$e.over?p:d):null;function _l(x,M){if($e.show){for(let D in x)$e[D]=x[D],D in Uu&&Ye(Hr,D,x[D]);M!==!1&&Rn("setSelect")}}i.setSelect=_l;function rx(x){if(v[x].show)Z&&kd(Zt[x],Rr);else if(Z&&bi(Zt[x],Rr),at){let D=Ct?ce[0]:ce[x];D!=null&&fs(D,-10,-10,H,Rt)}}function ks(x,M,D){Pu(x,{min:M,max:D})}function ts(x,M,D,O){M.focus!=null&&hx(x),M.show!=null&&v.forEach((q,tt)=>{tt>0&&(x==tt||x==null)&&(q.show=M.show,rx(tt),s==2?(ks(q.facets[0].scale,null,null),ks(q.facets[1].scale,null,null)):ks(q.scale,null,null),Vn())}),D!==!1&&Rn("setSeries",x,M),O&&jo("setSeries",i,x,M)}i.setSeries=ts;function ox(x,M){gn(C[x],M)}function ax(x,M){x.fill=xe(x.fill||null),x.dir=Ee(x.dir,-1),M=M??C.length,C.splice(M,0,x)}function lx(x){x==null?C.length=0:C.splice(x,1)}i.addBand=ax,i.setBand=ox,i.delBand=lx;function cx(x,M){v[x].alpha=M,at&&ce[x]!=null&&(ce[x].style.opacity=M),Z&&Zt[x]&&(Zt[x].style.opacity=M)}let ys,zs,dr,Vr={focus:!0};function hx(x){if(x!=dr){let M=x==null,D=zt.alpha!=1;v.forEach((O,q)=>{if(s==1||q>0){let tt=M||q==0||q==x;O._focus=M?null:tt,D&&cx(q,tt?1:zt.alpha)}}),dr=x,D&&Vn()}}Z&&ee&&Se(i_,dt,x=>{nt._lock||(te(x),dr!=null&&ts(null,Vr,!0,pn.setSeries))});function es(x,M,D){let O=S[M];D&&(x=x/Ce-(O.ori==1?le:Jt));let q=H;O.ori==1&&(q=Rt,x=q-x),O.dir==-1&&(x=q-x);let tt=O._min,pt=O._max,_t=x/q,bt=tt+(pt-tt)*_t,Nt=O.distr;return Nt==3?No(10,bt):Nt==4?mT(bt,O.asinh):Nt==100?O.bwd(bt):bt}function ux(x,M){let D=es(x,E,M);return Yi(D,t[0],an,ln)}i.valToIdx=x=>Yi(x,t[0]),i.posToIdx=ux,i.posToVal=es,i.valToPos=(x,M,D)=>S[M].ori==0?r(x,S[M],D?K:H,D?P:0):o(x,S[M],D?gt:Rt,D?b:0),i.setCursor=(x,M,D)=>{We=x.left,Ke=x.top,pr(null,M,D)};function yp(x,M){Ye(Hr,Po,$e.left=x),Ye(Hr,rl,$e.width=M)}function xp(x,M){Ye(Hr,"top",$e.top=x),Ye(Hr,ol,$e.height=M)}let Zo=L.ori==0?yp:xp,Ko=L.ori==1?yp:xp;function fx(){if(Z&&et.live)for(let x=s==2?1:0;x<v.length;x++){if(x==0&&ie)continue;let M=et.values[x],D=0;for(let O in M)Ut[x][D++].firstChild.nodeValue=M[O]}}function Nu(x,M){if(x!=null&&(x.idxs?x.idxs.forEach((D,O)=>{Y[O]=D}):xT(x.idx)||Y.fill(x.idx),et.idx=Y[0]),Z&&et.live){for(let D=0;D<v.length;D++)(D>0||s==1&&!ie)&&dx(D,Y[D]);fx()}yt=!1,M!==!1&&Rn("setLegend")}i.setLegend=Nu;function dx(x,M){let D=v[x],O=x==0&&B==2?fi:t[x],q;ie?q=D.values(i,x,M)??$t:(q=D.value(i,M==null?null:O[M],x,M),q=q==null?$t:{_:q}),et.values[x]=q}function pr(x,M,D){gp=We,_p=Ke,[We,Ke]=nt.move(i,We,Ke),nt.left=We,nt.top=Ke,at&&(Fr&&fs(Fr,Mn(We),0,H,Rt),Br&&fs(Br,0,Mn(Ke),H,Rt));let O,q=an>ln;ys=ze,zs=null;let tt=L.ori==0?H:Rt,pt=L.ori==1?H:Rt;if(We<0||nn==0||q){O=nt.idx=null;for(let _t=0;_t<v.length;_t++){let bt=ce[_t];bt!=null&&fs(bt,-10,-10,H,Rt)}ee&&ts(null,Vr,!0,x==null&&pn.setSeries),et.live&&(Y.fill(O),yt=!0)}else{let _t,bt,Nt;s==1&&(_t=L.ori==0?We:Ke,bt=es(_t,E),O=nt.idx=Yi(bt,t[0],an,ln),Nt=F(t[0][O],L,tt,0));let Ot=-10,kt=-10,ae=0,Ae=0,Me=!0,ge="",Qt="";for(let Xt=s==2?1:0;Xt<v.length;Xt++){let Xe=v[Xt],rn=Y[Xt],In=rn==null?null:s==1?t[Xt][rn]:t[Xt][1][rn],Fe=nt.dataIdx(i,Xt,O,bt),on=Fe==null?null:s==1?t[Xt][Fe]:t[Xt][1][Fe];if(yt=yt||on!=In||Fe!=rn,Y[Xt]=Fe,Xt>0&&Xe.show){let di=Fe==null?-10:Fe==O?Nt:F(s==1?t[0][Fe]:t[Xt][0][Fe],L,tt,0),Jn=on==null?-10:R(on,s==1?S[Xe.scale]:S[Xe.facets[1].scale],pt,0);if(ee&&on!=null){let Ti=L.ori==1?We:Ke,Ui=En(zt.dist(i,Xt,Fe,Jn,Ti));if(Ui<ys){let ns=zt.bias;if(ns!=0){let pi=es(Ti,Xe.scale),Ci=on>=0?1:-1,Fi=pi>=0?1:-1;Fi==Ci&&(Fi==1?ns==1?on>=pi:on<=pi:ns==1?on<=pi:on>=pi)&&(ys=Ui,zs=Xt)}else ys=Ui,zs=Xt}}if(yt||Ct){let Ti,Ui;L.ori==0?(Ti=di,Ui=Jn):(Ti=Jn,Ui=di);let ns,pi,Ci,Fi,is,jn,mi=!0,mr=mt.bbox;if(mr!=null){mi=!1;let Qn=mr(i,Xt);Ci=Qn.left,Fi=Qn.top,ns=Qn.width,pi=Qn.height}else Ci=Ti,Fi=Ui,ns=pi=mt.size(i,Xt);if(jn=mt.fill(i,Xt),is=mt.stroke(i,Xt),Ct)Xt==zs&&ys<=zt.prox&&(Ot=Ci,kt=Fi,ae=ns,Ae=pi,Me=mi,ge=jn,Qt=is);else{let Qn=ce[Xt];Qn!=null&&(Ge[Xt]=Ci,Zn[Xt]=Fi,h_(Qn,ns,pi,mi),l_(Qn,jn,is),fs(Qn,Di(Ci),Di(Fi),H,Rt))}}}}if(Ct){let Xt=zt.prox,Xe=dr==null?ys<=Xt:ys>Xt||zs!=dr;if(yt||Xe){let rn=ce[0];rn!=null&&(Ge[0]=Ot,Zn[0]=kt,h_(rn,ae,Ae,Me),l_(rn,ge,Qt),fs(rn,Di(Ot),Di(kt),H,Rt))}}}if($e.show&&Bs)if(x!=null){let[_t,bt]=pn.scales,[Nt,Ot]=pn.match,[kt,ae]=x.cursor.sync.scales,Ae=x.cursor.drag;if(Tn=Ae._x,Cn=Ae._y,Tn||Cn){let{left:Me,top:ge,width:Qt,height:Xt}=x.select,Xe=x.scales[kt].ori,rn=x.posToVal,In,Fe,on,di,Jn,Ti=_t!=null&&Nt(_t,kt),Ui=bt!=null&&Ot(bt,ae);Ti&&Tn?(Xe==0?(In=Me,Fe=Qt):(In=ge,Fe=Xt),on=S[_t],di=F(rn(In,kt),on,tt,0),Jn=F(rn(In+Fe,kt),on,tt,0),Zo(Zi(di,Jn),En(Jn-di))):Zo(0,tt),Ui&&Cn?(Xe==1?(In=Me,Fe=Qt):(In=ge,Fe=Xt),on=S[bt],di=R(rn(In,ae),on,pt,0),Jn=R(rn(In+Fe,ae),on,pt,0),Ko(Zi(di,Jn),En(Jn-di))):Ko(0,pt)}else Fu()}else{let _t=En(gp-pp),bt=En(_p-mp);if(L.ori==1){let ae=_t;_t=bt,bt=ae}Tn=Un.x&&_t>=Un.dist,Cn=Un.y&&bt>=Un.dist;let Nt=Un.uni;Nt!=null?Tn&&Cn&&(Tn=_t>=Nt,Cn=bt>=Nt,!Tn&&!Cn&&(bt>_t?Cn=!0:Tn=!0)):Un.x&&Un.y&&(Tn||Cn)&&(Tn=Cn=!0);let Ot,kt;Tn&&(L.ori==0?(Ot=kr,kt=We):(Ot=zr,kt=Ke),Zo(Zi(Ot,kt),En(kt-Ot)),Cn||Ko(0,pt)),Cn&&(L.ori==1?(Ot=kr,kt=We):(Ot=zr,kt=Ke),Ko(Zi(Ot,kt),En(kt-Ot)),Tn||Zo(0,tt)),!Tn&&!Cn&&(Zo(0,0),Ko(0,0))}if(Un._x=Tn,Un._y=Cn,x==null){if(D){if(Ip!=null){let[_t,bt]=pn.scales;pn.values[0]=_t!=null?es(L.ori==0?We:Ke,_t):null,pn.values[1]=bt!=null?es(L.ori==1?We:Ke,bt):null}jo(Pd,i,We,Ke,H,Rt,O)}if(ee){let _t=D&&pn.setSeries,bt=zt.prox;dr==null?ys<=bt&&ts(zs,Vr,!0,_t):ys>bt?ts(null,Vr,!0,_t):zs!=dr&&ts(zs,Vr,!0,_t)}}yt&&(et.idx=O,Nu()),M!==!1&&Rn("setCursor")}let Hs=null;Object.defineProperty(i,"rect",{get(){return Hs==null&&Jo(!1),Hs}});function Jo(x=!1){x?Hs=null:(Hs=p.getBoundingClientRect(),Rn("syncRect",Hs))}function vp(x,M,D,O,q,tt,pt){nt._lock||Bs&&x!=null&&x.movementX==0&&x.movementY==0||(Ou(x,M,D,O,q,tt,pt,!1,x!=null),x!=null?pr(null,!0,!0):pr(M,!0,!1))}function Ou(x,M,D,O,q,tt,pt,_t,bt){if(Hs==null&&Jo(!1),te(x),x!=null)D=x.clientX-Hs.left,O=x.clientY-Hs.top;else{if(D<0||O<0){We=-10,Ke=-10;return}let[Nt,Ot]=pn.scales,kt=M.cursor.sync,[ae,Ae]=kt.values,[Me,ge]=kt.scales,[Qt,Xt]=pn.match,Xe=M.axes[0].side%2==1,rn=L.ori==0?H:Rt,In=L.ori==1?H:Rt,Fe=Xe?tt:q,on=Xe?q:tt,di=Xe?O:D,Jn=Xe?D:O;if(Me!=null?D=Qt(Nt,Me)?a(ae,S[Nt],rn,0):-10:D=rn*(di/Fe),ge!=null?O=Xt(Ot,ge)?a(Ae,S[Ot],In,0):-10:O=In*(Jn/on),L.ori==1){let Ti=D;D=O,O=Ti}}bt&&(M==null||M.cursor.event.type==Pd)&&((D<=1||D>=H-1)&&(D=Tr(D,H)),(O<=1||O>=Rt-1)&&(O=Tr(O,Rt))),_t?(pp=D,mp=O,[kr,zr]=nt.move(i,D,O)):(We=D,Ke=O)}let Uu={width:0,height:0,left:0,top:0};function Fu(){_l(Uu,!1)}let Sp,bp,wp,Mp;function Ep(x,M,D,O,q,tt,pt){Bs=!0,Tn=Cn=Un._x=Un._y=!1,Ou(x,M,D,O,q,tt,pt,!0,!1),x!=null&&(Se(Ld,Fd,Ap,!1),jo(e_,i,kr,zr,H,Rt,null));let{left:_t,top:bt,width:Nt,height:Ot}=$e;Sp=_t,bp=bt,wp=Nt,Mp=Ot}function Ap(x,M,D,O,q,tt,pt){Bs=Un._x=Un._y=!1,Ou(x,M,D,O,q,tt,pt,!1,!0);let{left:_t,top:bt,width:Nt,height:Ot}=$e,kt=Nt>0||Ot>0,ae=Sp!=_t||bp!=bt||wp!=Nt||Mp!=Ot;if(kt&&ae&&_l($e),Un.setScale&&kt&&ae){let Ae=_t,Me=Nt,ge=bt,Qt=Ot;if(L.ori==1&&(Ae=bt,Me=Ot,ge=_t,Qt=Nt),Tn&&ks(E,es(Ae,E),es(Ae+Me,E)),Cn)for(let Xt in S){let Xe=S[Xt];Xt!=E&&Xe.from==null&&Xe.min!=ze&&ks(Xt,es(ge+Qt,Xt),es(ge,Xt))}Fu()}else nt.lock&&(nt._lock=!nt._lock,pr(M,!0,x!=null));x!=null&&(yn(Ld,Fd),jo(Ld,i,We,Ke,H,Rt,null))}function px(x,M,D,O,q,tt,pt){if(nt._lock)return;te(x);let _t=Bs;if(Bs){let bt=!0,Nt=!0,Ot=10,kt,ae;L.ori==0?(kt=Tn,ae=Cn):(kt=Cn,ae=Tn),kt&&ae&&(bt=We<=Ot||We>=H-Ot,Nt=Ke<=Ot||Ke>=Rt-Ot),kt&&bt&&(We=We<kr?0:H),ae&&Nt&&(Ke=Ke<zr?0:Rt),pr(null,!0,!0),Bs=!1}We=-10,Ke=-10,Y.fill(null),pr(null,!0,!0),_t&&(Bs=_t)}function Tp(x,M,D,O,q,tt,pt){nt._lock||(te(x),Yo(),Fu(),x!=null&&jo(s_,i,We,Ke,H,Rt,null))}function Cp(){T.forEach(OC),z(i.width,i.height,!0)}Ir(tu,Do,Cp);let Gr={};Gr.mousedown=Ep,Gr.mousemove=vp,Gr.mouseup=Ap,Gr.dblclick=Tp,Gr.setSeries=(x,M,D,O)=>{let q=pn.match[2];D=q(i,M,D),D!=-1&&ts(D,O,!0,!1)},at&&(Se(e_,p,Ep),Se(Pd,p,vp),Se(n_,p,x=>{te(x),Jo(!1)}),Se(i_,p,px),Se(s_,p,Tp),$d.add(i),i.syncRect=Jo);let yl=i.hooks=n.hooks||{};function Rn(x,M,D){Kn?Oe.push([x,M,D]):x in yl&&yl[x].forEach(O=>{O.call(null,i,M,D)})}(n.plugins||[]).forEach(x=>{for(let M in x.hooks)yl[M]=(yl[M]||[]).concat(x.hooks[M])});let Rp=(x,M,D)=>D,pn=gn({key:null,setSeries:!1,filters:{pub:m_,sub:m_},scales:[E,v[1]?v[1].scale:null],match:[g_,g_,Rp],values:[null,null]},nt.sync);pn.match.length==2&&pn.match.push(Rp),nt.sync=pn;let Ip=pn.key,Bu=fy(Ip);function jo(x,M,D,O,q,tt,pt){pn.filters.pub(x,M,D,O,q,tt,pt)&&Bu.pub(x,M,D,O,q,tt,pt)}Bu.sub(i);function mx(x,M,D,O,q,tt,pt){pn.filters.sub(x,M,D,O,q,tt,pt)&&Gr[x](null,M,D,O,q,tt,pt)}i.pub=mx;function gx(){Bu.unsub(i),$d.delete(i),cn.clear(),zd(tu,Do,Cp),l.remove(),dt?.remove(),Rn("destroy")}i.destroy=gx;function ku(){Rn("init",n,t),qo(t||n.data,!1),U[E]?Pu(E,U[E]):Yo(),lt=$e.show&&($e.width>0||$e.height>0),st=yt=!0,z(n.width,n.height)}return v.forEach(Dr),T.forEach(ps),e?e instanceof HTMLElement?(e.appendChild(l),ku()):e(i,ku):ku(),i}An.assign=gn;An.fmtNum=jd;An.rangeNum=eu;An.rangeLog=su;An.rangeAsinh=Kd;An.orient=Lr;An.pxRatio=Ce;An.join=AT;An.fmtDate=tp,An.tzDate=FT;An.sync=fy;{An.addGap=xC,An.clipGaps=au;let n=An.paths={points:yy};n.linear=vy,n.stepped=bC,n.bars=wC,n.spline=EC}var My=100,Ty=118,uu=n=>n.reduce((t,e)=>t+e,0),Ey=n=>Math.min(...n),ap=[{name:"force",title:"Total force, N",least:1,ofAll:uu},{name:"strength",title:"Total strength",least:.1,ofAll:uu},{name:"count",title:"Contacts",least:2,isCount:!0,ofAll:uu},{name:"rate",title:"Frames a second",least:10,ofAll:Ey},{name:"noise",title:"Signal to noise, dB",least:20,ofAll:Ey},{name:"lost",title:"Frames lost a second",least:1,ofAll:uu}],Cy=6,lp=[[],[6,3],[2,3]],fu=class{constructor(t){this.session=t,this.isSeen=!1,this.drawn=0,this.restart(),this.spaces=[],this.plots=ap.map(e=>UC(e)),t.listen(e=>this.update(e)),new ResizeObserver(()=>this.resize()).observe(J("plots"))}setSeen(t){this.isSeen=t,t&&this.resize()}resize(){let t=J("plots").clientWidth;if(!(!this.isSeen||t===0)){for(let{plot:e}of this.plots)e.setSize({width:t,height:Ty});this.draw()}}update(t){t.has("new")&&this.restart(),this.take(),t.has("look")&&this.plots.forEach(({plot:e})=>e.redraw(!1,!0)),this.isSeen&&performance.now()-this.drawn>My?this.draw():this.isSeen&&this.session.player&&this.drawLater()}drawLater(){clearTimeout(this.later),this.later=setTimeout(()=>this.session.player&&this.draw(),My)}restart(){this.histories=new $r,this.taken=new Set,this.now=0}take(){if(this.session.player)return;let t=this.taken;this.taken=new Set;for(let{space:e,shown:i,times:s}of this.session.skins)for(let r of["contacts","status"].filter(o=>i[o]))this.taken.add(i[r]),t.has(i[r])||this.histories.take(e,r,this.timeOf(s[r]),i[r])}timeOf(t){let e=Number(t)/1e9;return this.now=Math.abs(e-this.now)>60?e:Math.max(this.now,e),e}draw(){this.drawn=performance.now();let{player:t,recorded:e}=this.session,i=t?Number(t.position)/1e9:this.now,s=t?e.histories:this.histories;this.showLines(s.spaces),this.showUseful(),ap.forEach(({name:r,isCount:o,ofAll:a},c)=>{let{plot:l,box:h,output:f}=this.plots[c];if(h.hidden)return;let u=s.all.map(_=>t?_.before(r,i):_.of(r));l.setData(Xp(u,i));let d=u.map(({values:_})=>_.at(-1)).filter(Number.isFinite),p=d.length>0?a(d):NaN;Bt(f,o&&Number.isFinite(p)?String(p):Qe(p))})}showUseful(){let t=this.session.skins.map(({shown:{skin:i,contacts:s}})=>i?.is_calibrated??s?.contacts.some(({force:r})=>Number.isFinite(r))??!1),e={force:!t.some(Boolean),strength:t.length>0&&t.every(Boolean),noise:this.session.isWhole};ap.forEach(({name:i},s)=>this.plots[s].box.hidden=e[i]??!1)}showLines(t){if(t.join(`
`)===this.spaces.join(`
`))return;for(let{plot:i}of this.plots)this.spaces.forEach(()=>i.delSeries(1)),t.forEach((s,r)=>i.addSeries(FC(r),r+1)),i.setData([[],...t.map(()=>[])]);this.spaces=t;let e=t.every(i=>i===Ml);Gn(J("plot-skins"),e?[]:t,BC,kC)}};function UC({title:n,least:t,isCount:e}){let i=qt("output"),s=qt("figure",{className:"plot"},qt("h3",{},n,i));return J("plots").append(s),{plot:new An({width:300,height:Ty,legend:{show:!1},cursor:{y:!1,drag:{x:!1,y:!1}},scales:{x:{time:!1,range:()=>[-60,0]},y:{range:(o,a,c)=>zC(a,c,t)}},axes:[ul({values:(o,a)=>a.map(c=>`${c} s`),size:26}),ul({size:44,space:28,...HC(e)})],series:[{}]},[[]],s),box:s,output:i}}var Ry=n=>lp[Math.floor(n/Cy)%lp.length],Iy=n=>`--line-${n%Cy}`;function FC(n){return{stroke:()=>hr(Iy(n)),dash:Ry(n),width:1.5,points:{show:!1},spanGaps:!1}}function BC(){return qt("li")}function kC(n,t,e){Bt(n,ea(t)),n.style.borderColor=`var(${Iy(e)})`,n.style.borderLeftStyle=["solid","dashed","dotted"][lp.indexOf(Ry(e))]}function zC(n,t,e){return n===null||t===null?[0,e]:[Math.min(0,n),Math.max(e,t*1.1)]}function HC(n){return n?{incrs:[1,2,5,10,20,50]}:{}}function ul(n){let t={stroke:()=>hr("--line"),width:1};return{stroke:()=>hr("--muted"),grid:t,ticks:{...t,size:4},font:"11px system-ui, sans-serif",...n}}function hr(n){return getComputedStyle(document.documentElement).getPropertyValue(n).trim()}function VC({polynomial:n,numTables:t}){let e=new Uint32Array(256*t);for(let i=0;i<256;i++){let s=i;s=(s&1)*n^s>>>1,s=(s&1)*n^s>>>1,s=(s&1)*n^s>>>1,s=(s&1)*n^s>>>1,s=(s&1)*n^s>>>1,s=(s&1)*n^s>>>1,s=(s&1)*n^s>>>1,s=(s&1)*n^s>>>1,e[i]=s}for(let i=256;i<e.length;i++){let s=e[i-256];e[i]=e[s&255]^s>>>8}return e}var ds=VC({polynomial:3988292384,numTables:8});function du(){return-1}function fl(n,t){let e=t.byteLength,i=new DataView(t.buffer,t.byteOffset,e),s=n,r=0,o=-i.byteOffset&3;for(;r<o&&r<e;r++)s=ds[(s^i.getUint8(r))&255]^s>>>8;if(r===e)return s;r=o;let a=e-r;for(;a>=8;r+=8,a-=8){s^=i.getUint32(r,!0);let c=i.getUint32(r+4,!0);s=ds[0*256+(c>>>24&255)]^ds[1*256+(c>>>16&255)]^ds[2*256+(c>>>8&255)]^ds[3*256+(c>>>0&255)]^ds[4*256+(s>>>24&255)]^ds[5*256+(s>>>16&255)]^ds[6*256+(s>>>8&255)]^ds[7*256+(s>>>0&255)]}for(let c=r;c<e;c++)s=ds[(s^i.getUint8(c))&255]^s>>>8;return s}function pu(n){return(n^-1)>>>0}function Os(n){return pu(fl(du(),n))}var Ue=function(n,t,e,i){function s(r){return r instanceof e?r:new e(function(o){o(r)})}return new(e||(e=Promise))(function(r,o){function a(h){try{l(i.next(h))}catch(f){o(f)}}function c(h){try{l(i.throw(h))}catch(f){o(f)}}function l(h){h.done?r(h.value):s(h.value).then(a,c)}l((i=i.apply(n,t||[])).next())})},Le=function(n,t){var e={label:0,sent:function(){if(r[0]&1)throw r[1];return r[1]},trys:[],ops:[]},i,s,r,o=Object.create((typeof Iterator=="function"?Iterator:Object).prototype);return o.next=a(0),o.throw=a(1),o.return=a(2),typeof Symbol=="function"&&(o[Symbol.iterator]=function(){return this}),o;function a(l){return function(h){return c([l,h])}}function c(l){if(i)throw new TypeError("Generator is already executing.");for(;o&&(o=0,l[0]&&(e=0)),e;)try{if(i=1,s&&(r=l[0]&2?s.return:l[0]?s.throw||((r=s.return)&&r.call(s),0):s.next)&&!(r=r.call(s,l[1])).done)return r;switch(s=0,r&&(l=[l[0]&2,r.value]),l[0]){case 0:case 1:r=l;break;case 4:return e.label++,{value:l[1],done:!1};case 5:e.label++,s=l[1],l=[0];continue;case 7:l=e.ops.pop(),e.trys.pop();continue;default:if(r=e.trys,!(r=r.length>0&&r[r.length-1])&&(l[0]===6||l[0]===2)){e=0;continue}if(l[0]===3&&(!r||l[1]>r[0]&&l[1]<r[3])){e.label=l[1];break}if(l[0]===6&&e.label<r[1]){e.label=r[1],r=l;break}if(r&&e.label<r[2]){e.label=r[2],e.ops.push(l);break}r[2]&&e.ops.pop(),e.trys.pop();continue}l=t.call(n,e)}catch(h){l=[6,h],s=0}finally{i=r=0}if(l[0]&5)throw l[1];return{value:l[0]?l[1]:void 0,done:!0}}},Ei=function(n,t){var e=typeof Symbol=="function"&&n[Symbol.iterator];if(!e)return n;var i=e.call(n),s,r=[],o;try{for(;(t===void 0||t-- >0)&&!(s=i.next()).done;)r.push(s.value)}catch(a){o={error:a}}finally{try{s&&!s.done&&(e=i.return)&&e.call(i)}finally{if(o)throw o.error}}return r},Ni=function(n,t,e){if(e||arguments.length===2)for(var i=0,s=t.length,r;i<s;i++)(r||!(i in t))&&(r||(r=Array.prototype.slice.call(t,0,i)),r[i]=t[i]);return n.concat(r||Array.prototype.slice.call(t))},Py=function(n){var t=typeof Symbol=="function"&&Symbol.iterator,e=t&&n[t],i=0;if(e)return e.call(n);if(n&&typeof n.length=="number")return{next:function(){return n&&i>=n.length&&(n=void 0),{value:n&&n[i++],done:!n}}};throw new TypeError(t?"Object is not iterable.":"Symbol.iterator is not defined.")},ED=(function(){function n(t){t===void 0&&(t=n.minComparator);var e=this;this.compare=t,this.heapArray=[],this._limit=0,this.offer=this.add,this.element=this.peek,this.poll=this.pop,this._invertedCompare=function(i,s){return e.compare(i,s).then(function(r){return-1*r})}}return n.getChildrenIndexOf=function(t){return[t*2+1,t*2+2]},n.getParentIndexOf=function(t){if(t<=0)return-1;var e=t%2?1:2;return Math.floor((t-e)/2)},n.getSiblingIndexOf=function(t){if(t<=0)return-1;var e=t%2?1:-1;return t+e},n.minComparator=function(t,e){return Ue(this,void 0,void 0,function(){return Le(this,function(i){return t>e?[2,1]:t<e?[2,-1]:[2,0]})})},n.maxComparator=function(t,e){return Ue(this,void 0,void 0,function(){return Le(this,function(i){return e>t?[2,1]:e<t?[2,-1]:[2,0]})})},n.minComparatorNumber=function(t,e){return Ue(this,void 0,void 0,function(){return Le(this,function(i){return[2,t-e]})})},n.maxComparatorNumber=function(t,e){return Ue(this,void 0,void 0,function(){return Le(this,function(i){return[2,e-t]})})},n.defaultIsEqual=function(t,e){return Ue(this,void 0,void 0,function(){return Le(this,function(i){return[2,t===e]})})},n.print=function(t){function e(h){var f=n.getParentIndexOf(h);return Math.floor(Math.log2(f+1))}function i(h,f){for(var u="";f>0;--f)u+=h;return u}for(var s=0,r=[],o=e(t.length-1)+2,a=0;s<t.length;){var c=e(s)+1;s===0&&(c=0);var l=String(t.get(s));l.length>a&&(a=l.length),r[c]=r[c]||[],r[c].push(l),s+=1}return r.map(function(h,f){var u=Math.pow(2,o-f)-1;return i(" ",Math.floor(u/2)*a)+h.map(function(d){var p=(a-d.length)/2;return i(" ",Math.ceil(p))+d+i(" ",Math.floor(p))}).join(i(" ",u*a))}).join(`
`)},n.heapify=function(t,e){return Ue(this,void 0,void 0,function(){var i;return Le(this,function(s){switch(s.label){case 0:return i=new n(e),i.heapArray=t,[4,i.init()];case 1:return s.sent(),[2,i]}})})},n.heappop=function(t,e){var i=new n(e);return i.heapArray=t,i.pop()},n.heappush=function(t,e,i){return Ue(this,void 0,void 0,function(){var s;return Le(this,function(r){switch(r.label){case 0:return s=new n(i),s.heapArray=t,[4,s.push(e)];case 1:return r.sent(),[2]}})})},n.heappushpop=function(t,e,i){var s=new n(i);return s.heapArray=t,s.pushpop(e)},n.heapreplace=function(t,e,i){var s=new n(i);return s.heapArray=t,s.replace(e)},n.heaptop=function(t,e,i){e===void 0&&(e=1);var s=new n(i);return s.heapArray=t,s.top(e)},n.heapbottom=function(t,e,i){e===void 0&&(e=1);var s=new n(i);return s.heapArray=t,s.bottom(e)},n.nlargest=function(t,e,i){return Ue(this,void 0,void 0,function(){var s;return Le(this,function(r){switch(r.label){case 0:return s=new n(i),s.heapArray=Ni([],Ei(e),!1),[4,s.init()];case 1:return r.sent(),[2,s.top(t)]}})})},n.nsmallest=function(t,e,i){return Ue(this,void 0,void 0,function(){var s;return Le(this,function(r){switch(r.label){case 0:return s=new n(i),s.heapArray=Ni([],Ei(e),!1),[4,s.init()];case 1:return r.sent(),[2,s.bottom(t)]}})})},n.prototype.add=function(t){return Ue(this,void 0,void 0,function(){return Le(this,function(e){switch(e.label){case 0:return[4,this._sortNodeUp(this.heapArray.push(t)-1)];case 1:return e.sent(),this._applyLimit(),[2,!0]}})})},n.prototype.addAll=function(t){return Ue(this,void 0,void 0,function(){var e,i,s;return Le(this,function(r){switch(r.label){case 0:e=this.length,(s=this.heapArray).push.apply(s,Ni([],Ei(t),!1)),i=this.length,r.label=1;case 1:return e<i?[4,this._sortNodeUp(e)]:[3,4];case 2:r.sent(),r.label=3;case 3:return++e,[3,1];case 4:return this._applyLimit(),[2,!0]}})})},n.prototype.bottom=function(){return Ue(this,arguments,void 0,function(t){return t===void 0&&(t=1),Le(this,function(e){return this.heapArray.length===0||t<=0?[2,[]]:this.heapArray.length===1?[2,[this.heapArray[0]]]:t>=this.heapArray.length?[2,Ni([],Ei(this.heapArray),!1)]:[2,this._bottomN_push(~~t)]})})},n.prototype.check=function(){return Ue(this,void 0,void 0,function(){var t,e,i,s,r,o,a,c,l;return Le(this,function(h){switch(h.label){case 0:t=0,h.label=1;case 1:if(!(t<this.heapArray.length))return[3,10];e=this.heapArray[t],i=this.getChildrenOf(t),h.label=2;case 2:h.trys.push([2,7,8,9]),s=(c=void 0,Py(i)),r=s.next(),h.label=3;case 3:return r.done?[3,6]:(o=r.value,[4,this.compare(e,o)]);case 4:if(h.sent()>0)return[2,e];h.label=5;case 5:return r=s.next(),[3,3];case 6:return[3,9];case 7:return a=h.sent(),c={error:a},[3,9];case 8:try{r&&!r.done&&(l=s.return)&&l.call(s)}finally{if(c)throw c.error}return[7];case 9:return++t,[3,1];case 10:return[2]}})})},n.prototype.clear=function(){this.heapArray=[]},n.prototype.clone=function(){var t=new n(this.comparator());return t.heapArray=this.toArray(),t._limit=this._limit,t},n.prototype.comparator=function(){return this.compare},n.prototype.contains=function(t){return Ue(this,arguments,void 0,function(e,i){var s,r,o,a,c,l;return i===void 0&&(i=n.defaultIsEqual),Le(this,function(h){switch(h.label){case 0:h.trys.push([0,5,6,7]),s=Py(this.heapArray),r=s.next(),h.label=1;case 1:return r.done?[3,4]:(o=r.value,[4,i(o,e)]);case 2:if(h.sent())return[2,!0];h.label=3;case 3:return r=s.next(),[3,1];case 4:return[3,7];case 5:return a=h.sent(),c={error:a},[3,7];case 6:try{r&&!r.done&&(l=s.return)&&l.call(s)}finally{if(c)throw c.error}return[7];case 7:return[2,!1]}})})},n.prototype.init=function(t){return Ue(this,void 0,void 0,function(){var e;return Le(this,function(i){switch(i.label){case 0:t&&(this.heapArray=Ni([],Ei(t),!1)),e=n.getParentIndexOf(this.length-1),i.label=1;case 1:return e>=0?[4,this._sortNodeDown(e)]:[3,4];case 2:i.sent(),i.label=3;case 3:return--e,[3,1];case 4:return this._applyLimit(),[2]}})})},n.prototype.isEmpty=function(){return this.length===0},n.prototype.leafs=function(){if(this.heapArray.length===0)return[];var t=n.getParentIndexOf(this.heapArray.length-1);return this.heapArray.slice(t+1)},Object.defineProperty(n.prototype,"length",{get:function(){return this.heapArray.length},enumerable:!1,configurable:!0}),Object.defineProperty(n.prototype,"limit",{get:function(){return this._limit},set:function(t){this._limit=~~t,this._applyLimit()},enumerable:!1,configurable:!0}),n.prototype.peek=function(){return this.heapArray[0]},n.prototype.pop=function(){return Ue(this,void 0,void 0,function(){var t;return Le(this,function(e){return t=this.heapArray.pop(),this.length>0&&t!==void 0?[2,this.replace(t)]:[2,t]})})},n.prototype.push=function(){for(var t=[],e=0;e<arguments.length;e++)t[e]=arguments[e];return Ue(this,void 0,void 0,function(){return Le(this,function(i){return t.length<1?[2,!1]:t.length===1?[2,this.add(t[0])]:[2,this.addAll(t)]})})},n.prototype.pushpop=function(t){return Ue(this,void 0,void 0,function(){var e;return Le(this,function(i){switch(i.label){case 0:return[4,this.compare(this.heapArray[0],t)];case 1:return i.sent()<0?(e=Ei([this.heapArray[0],t],2),t=e[0],this.heapArray[0]=e[1],[4,this._sortNodeDown(0)]):[3,3];case 2:i.sent(),i.label=3;case 3:return[2,t]}})})},n.prototype.remove=function(t){return Ue(this,arguments,void 0,function(e,i){var s,r,o,a=this;return i===void 0&&(i=n.defaultIsEqual),Le(this,function(c){switch(c.label){case 0:return this.heapArray.length?e!==void 0?[3,2]:[4,this.pop()]:[2,!1];case 1:return c.sent(),[2,!0];case 2:s=[0],c.label=3;case 3:return s.length?(r=s.shift(),[4,i(this.heapArray[r],e)]):[3,13];case 4:return c.sent()?r!==0?[3,6]:[4,this.pop()]:[3,11];case 5:return c.sent(),[3,10];case 6:return r!==this.heapArray.length-1?[3,7]:(this.heapArray.pop(),[3,10]);case 7:return this.heapArray.splice(r,1,this.heapArray.pop()),[4,this._sortNodeUp(r)];case 8:return c.sent(),[4,this._sortNodeDown(r)];case 9:c.sent(),c.label=10;case 10:return[2,!0];case 11:o=n.getChildrenIndexOf(r).filter(function(l){return l<a.heapArray.length}),s.push.apply(s,Ni([],Ei(o),!1)),c.label=12;case 12:return[3,3];case 13:return[2,!1]}})})},n.prototype.replace=function(t){return Ue(this,void 0,void 0,function(){var e;return Le(this,function(i){switch(i.label){case 0:return e=this.heapArray[0],this.heapArray[0]=t,[4,this._sortNodeDown(0)];case 1:return i.sent(),[2,e]}})})},n.prototype.size=function(){return this.length},n.prototype.top=function(){return Ue(this,arguments,void 0,function(t){return t===void 0&&(t=1),Le(this,function(e){return this.heapArray.length===0||t<=0?[2,[]]:this.heapArray.length===1||t===1?[2,[this.heapArray[0]]]:t>=this.heapArray.length?[2,Ni([],Ei(this.heapArray),!1)]:[2,this._topN_push(~~t)]})})},n.prototype.toArray=function(){return Ni([],Ei(this.heapArray),!1)},n.prototype.toString=function(){return this.heapArray.toString()},n.prototype.get=function(t){return this.heapArray[t]},n.prototype.getChildrenOf=function(t){var e=this;return n.getChildrenIndexOf(t).map(function(i){return e.heapArray[i]}).filter(function(i){return i!==void 0})},n.prototype.getParentOf=function(t){var e=n.getParentIndexOf(t);return this.heapArray[e]},n.prototype[Symbol.iterator]=function(){return Le(this,function(t){switch(t.label){case 0:return this.length?[4,this.pop()]:[3,2];case 1:return t.sent(),[3,0];case 2:return[2]}})},n.prototype.iterator=function(){return this},n.prototype._applyLimit=function(){if(this._limit&&this._limit<this.heapArray.length)for(var t=this.heapArray.length-this._limit;t;)this.heapArray.pop(),--t},n.prototype._bottomN_push=function(t){return Ue(this,void 0,void 0,function(){var e,i,s,r,a,o,a;return Le(this,function(c){switch(c.label){case 0:return e=new n(this.compare),e.limit=t,e.heapArray=this.heapArray.slice(-t),[4,e.init()];case 1:for(c.sent(),i=this.heapArray.length-1-t,s=n.getParentIndexOf(i),r=[],a=i;a>s;--a)r.push(a);o=this.heapArray,c.label=2;case 2:return r.length?(a=r.shift(),[4,this.compare(o[a],e.peek())]):[3,6];case 3:return c.sent()>0?[4,e.replace(o[a])]:[3,5];case 4:c.sent(),a%2&&r.push(n.getParentIndexOf(a)),c.label=5;case 5:return[3,2];case 6:return[2,e.toArray()]}})})},n.prototype._moveNode=function(t,e){var i=this.heapArray[t];this.heapArray[t]=this.heapArray[e],this.heapArray[e]=i},n.prototype._sortNodeDown=function(t){return Ue(this,void 0,void 0,function(){var e,i,s,r,o,a,c;return Le(this,function(l){switch(l.label){case 0:e=this.heapArray.length,i=t,s=this.heapArray[t],r=2*t+1,l.label=1;case 1:return r<e?(o=r+1,c=o>=e,c?[3,3]:[4,this.compare(this.heapArray[r],this.heapArray[o])]):[3,5];case 2:c=l.sent()<0,l.label=3;case 3:return a=c?r:o,[4,this.compare(this.heapArray[a],s)];case 4:if(l.sent()<0)this.heapArray[t]=this.heapArray[a],t=a,r=2*t+1;else return[3,5];return[3,1];case 5:return t!==i&&(this.heapArray[t]=s),[2]}})})},n.prototype._sortNodeUp=function(t){return Ue(this,void 0,void 0,function(){var e,i,s;return Le(this,function(r){switch(r.label){case 0:e=this.heapArray[t],i=t,r.label=1;case 1:return t>0?(s=n.getParentIndexOf(t),[4,this.compare(e,this.heapArray[s])]):[3,3];case 2:if(r.sent()<0)this.heapArray[t]=this.heapArray[s],t=s;else return[3,3];return[3,1];case 3:return t!==i&&(this.heapArray[t]=e),[2]}})})},n.prototype._topN_push=function(t){return Ue(this,void 0,void 0,function(){var e,i,s,r;return Le(this,function(o){switch(o.label){case 0:e=new n(this._invertedCompare),e.limit=t,i=[0],s=this.heapArray,o.label=1;case 1:return i.length?(r=i.shift(),r<s.length?e.length<t?[4,e.push(s[r])]:[3,3]:[3,6]):[3,7];case 2:return o.sent(),i.push.apply(i,Ni([],Ei(n.getChildrenIndexOf(r)),!1)),[3,6];case 3:return[4,this.compare(s[r],e.peek())];case 4:return o.sent()<0?[4,e.replace(s[r])]:[3,6];case 5:o.sent(),i.push.apply(i,Ni([],Ei(n.getChildrenIndexOf(r)),!1)),o.label=6;case 6:return[3,1];case 7:return[2,e.toArray()]}})})},n.prototype._topN_fill=function(t){return Ue(this,void 0,void 0,function(){var e,i,s,r,o,o;return Le(this,function(a){switch(a.label){case 0:return e=this.heapArray,i=new n(this._invertedCompare),i.limit=t,i.heapArray=e.slice(0,t),[4,i.init()];case 1:for(a.sent(),s=n.getParentIndexOf(t-1)+1,r=[],o=s;o<t;++o)r.push.apply(r,Ni([],Ei(n.getChildrenIndexOf(o).filter(function(c){return c<e.length})),!1));(t-1)%2&&r.push(t),a.label=2;case 2:return r.length?(o=r.shift(),o<e.length?[4,this.compare(e[o],i.peek())]:[3,5]):[3,6];case 3:return a.sent()<0?[4,i.replace(e[o])]:[3,5];case 4:a.sent(),r.push.apply(r,Ni([],Ei(n.getChildrenIndexOf(o)),!1)),a.label=5;case 5:return[3,2];case 6:return[2,i.toArray()]}})})},n.prototype._topN_heap=function(t){return Ue(this,void 0,void 0,function(){var e,i,s,r,o;return Le(this,function(a){switch(a.label){case 0:e=this.clone(),i=[],s=0,a.label=1;case 1:return s<t?(o=(r=i).push,[4,e.pop()]):[3,4];case 2:o.apply(r,[a.sent()]),a.label=3;case 3:return++s,[3,1];case 4:return[2,i]}})})},n.prototype._topIdxOf=function(t){return Ue(this,void 0,void 0,function(){var e,i,s,r;return Le(this,function(o){switch(o.label){case 0:if(!t.length)return[2,-1];e=0,i=t[e],s=1,o.label=1;case 1:return s<t.length?[4,this.compare(t[s],i)]:[3,4];case 2:r=o.sent(),r<0&&(e=s,i=t[s]),o.label=3;case 3:return++s,[3,1];case 4:return[2,e]}})})},n.prototype._topOf=function(){for(var t=[],e=0;e<arguments.length;e++)t[e]=arguments[e];return Ue(this,void 0,void 0,function(){var i;return Le(this,function(s){switch(s.label){case 0:return i=new n(this.compare),[4,i.init(t)];case 1:return s.sent(),[2,i.peek()]}})})},n})(),GC=function(n,t){var e={label:0,sent:function(){if(r[0]&1)throw r[1];return r[1]},trys:[],ops:[]},i,s,r,o=Object.create((typeof Iterator=="function"?Iterator:Object).prototype);return o.next=a(0),o.throw=a(1),o.return=a(2),typeof Symbol=="function"&&(o[Symbol.iterator]=function(){return this}),o;function a(l){return function(h){return c([l,h])}}function c(l){if(i)throw new TypeError("Generator is already executing.");for(;o&&(o=0,l[0]&&(e=0)),e;)try{if(i=1,s&&(r=l[0]&2?s.return:l[0]?s.throw||((r=s.return)&&r.call(s),0):s.next)&&!(r=r.call(s,l[1])).done)return r;switch(s=0,r&&(l=[l[0]&2,r.value]),l[0]){case 0:case 1:r=l;break;case 4:return e.label++,{value:l[1],done:!1};case 5:e.label++,s=l[1],l=[0];continue;case 7:l=e.ops.pop(),e.trys.pop();continue;default:if(r=e.trys,!(r=r.length>0&&r[r.length-1])&&(l[0]===6||l[0]===2)){e=0;continue}if(l[0]===3&&(!r||l[1]>r[0]&&l[1]<r[3])){e.label=l[1];break}if(l[0]===6&&e.label<r[1]){e.label=r[1],r=l;break}if(r&&e.label<r[2]){e.label=r[2],e.ops.push(l);break}r[2]&&e.ops.pop(),e.trys.pop();continue}l=t.call(n,e)}catch(h){l=[6,h],s=0}finally{i=r=0}if(l[0]&5)throw l[1];return{value:l[0]?l[1]:void 0,done:!0}}},Yn=function(n,t){var e=typeof Symbol=="function"&&n[Symbol.iterator];if(!e)return n;var i=e.call(n),s,r=[],o;try{for(;(t===void 0||t-- >0)&&!(s=i.next()).done;)r.push(s.value)}catch(a){o={error:a}}finally{try{s&&!s.done&&(e=i.return)&&e.call(i)}finally{if(o)throw o.error}}return r},oi=function(n,t,e){if(e||arguments.length===2)for(var i=0,s=t.length,r;i<s;i++)(r||!(i in t))&&(r||(r=Array.prototype.slice.call(t,0,i)),r[i]=t[i]);return n.concat(r||Array.prototype.slice.call(t))};var Ly=(function(){function n(t){t===void 0&&(t=n.minComparator);var e=this;this.compare=t,this.heapArray=[],this._limit=0,this.offer=this.add,this.element=this.peek,this.poll=this.pop,this.removeAll=this.clear,this._invertedCompare=function(i,s){return-1*e.compare(i,s)}}return n.getChildrenIndexOf=function(t){return[t*2+1,t*2+2]},n.getParentIndexOf=function(t){return t<=0?-1:t-1>>1},n.getSiblingIndexOf=function(t){if(t<=0)return-1;var e=t%2?1:-1;return t+e},n.minComparator=function(t,e){return t>e?1:t<e?-1:0},n.maxComparator=function(t,e){return e>t?1:e<t?-1:0},n.minComparatorNumber=function(t,e){return t-e},n.maxComparatorNumber=function(t,e){return e-t},n.defaultIsEqual=function(t,e){return t===e},n.print=function(t){function e(h){var f=n.getParentIndexOf(h);return Math.floor(Math.log2(f+1))}function i(h,f){for(var u="";f>0;--f)u+=h;return u}for(var s=0,r=[],o=e(t.length-1)+2,a=0;s<t.length;){var c=e(s)+1;s===0&&(c=0);var l=String(t.get(s));l.length>a&&(a=l.length),r[c]=r[c]||[],r[c].push(l),s+=1}return r.map(function(h,f){var u=Math.pow(2,o-f)-1;return i(" ",Math.floor(u/2)*a)+h.map(function(d){var p=(a-d.length)/2;return i(" ",Math.ceil(p))+d+i(" ",Math.floor(p))}).join(i(" ",u*a))}).join(`
`)},n.heapify=function(t,e){var i=new n(e);return i.heapArray=t,i.init(),i},n.heappop=function(t,e){var i=new n(e);return i.heapArray=t,i.pop()},n.heappush=function(t,e,i){var s=new n(i);s.heapArray=t,s.push(e)},n.heappushpop=function(t,e,i){var s=new n(i);return s.heapArray=t,s.pushpop(e)},n.heapreplace=function(t,e,i){var s=new n(i);return s.heapArray=t,s.replace(e)},n.heaptop=function(t,e,i){e===void 0&&(e=1);var s=new n(i);return s.heapArray=t,s.top(e)},n.heapbottom=function(t,e,i){e===void 0&&(e=1);var s=new n(i);return s.heapArray=t,s.bottom(e)},n.nlargest=function(t,e,i){var s=new n(i);return s.heapArray=oi([],Yn(e),!1),s.init(),s.top(t)},n.nsmallest=function(t,e,i){var s=new n(i);return s.heapArray=oi([],Yn(e),!1),s.init(),s.bottom(t)},n.prototype.add=function(t){return this._sortNodeUp(this.heapArray.push(t)-1),this._applyLimit(),!0},n.prototype.addAll=function(t){var e,i=this.length;(e=this.heapArray).push.apply(e,oi([],Yn(t),!1));for(var s=this.length;i<s;++i)this._sortNodeUp(i);return this._applyLimit(),!0},n.prototype.bottom=function(t){return t===void 0&&(t=1),this.heapArray.length===0||t<=0?[]:this.heapArray.length===1?[this.heapArray[0]]:t>=this.heapArray.length?oi([],Yn(this.heapArray),!1):this._bottomN_push(~~t)},n.prototype.check=function(){var t=this;return this.heapArray.find(function(e,i){return!!t.getChildrenOf(i).find(function(s){return t.compare(e,s)>0})})},n.prototype.clear=function(){this.heapArray=[]},n.prototype.clone=function(){var t=new n(this.comparator());return t.heapArray=this.toArray(),t._limit=this._limit,t},n.prototype.comparator=function(){return this.compare},n.prototype.contains=function(t,e){return e===void 0&&(e=n.defaultIsEqual),this.indexOf(t,e)!==-1},n.prototype.init=function(t){t&&(this.heapArray=oi([],Yn(t),!1));for(var e=n.getParentIndexOf(this.length-1);e>=0;--e)this._sortNodeDown(e);this._applyLimit()},n.prototype.isEmpty=function(){return this.length===0},n.prototype.indexOf=function(t,e){if(e===void 0&&(e=n.defaultIsEqual),this.heapArray.length===0)return-1;for(var i=[],s=0;s<this.heapArray.length;){var r=this.heapArray[s];if(e(r,t))return s;this.compare(r,t)<=0&&i.push.apply(i,oi([],Yn(n.getChildrenIndexOf(s)),!1)),s=i.shift()||this.heapArray.length}return-1},n.prototype.indexOfEvery=function(t,e){if(e===void 0&&(e=n.defaultIsEqual),this.heapArray.length===0)return[];for(var i=[],s=[],r=0;r<this.heapArray.length;){var o=this.heapArray[r];e(o,t)?(s.push(r),i.push.apply(i,oi([],Yn(n.getChildrenIndexOf(r)),!1))):this.compare(o,t)<=0&&i.push.apply(i,oi([],Yn(n.getChildrenIndexOf(r)),!1)),r=i.shift()||this.heapArray.length}return s},n.prototype.leafs=function(){if(this.heapArray.length===0)return[];var t=n.getParentIndexOf(this.heapArray.length-1);return this.heapArray.slice(t+1)},Object.defineProperty(n.prototype,"length",{get:function(){return this.heapArray.length},enumerable:!1,configurable:!0}),Object.defineProperty(n.prototype,"limit",{get:function(){return this._limit},set:function(t){t<0||isNaN(t)?this._limit=0:this._limit=~~t,this._applyLimit()},enumerable:!1,configurable:!0}),n.prototype.setLimit=function(t){return this.limit=t,t<0||isNaN(t)?NaN:this._limit},n.prototype.peek=function(){return this.heapArray[0]},n.prototype.pop=function(){var t=this.heapArray.pop();return this.length>0&&t!==void 0?this.replace(t):t},n.prototype.push=function(){for(var t=[],e=0;e<arguments.length;e++)t[e]=arguments[e];return t.length<1?!1:t.length===1?this.add(t[0]):this.addAll(t)},n.prototype.pushpop=function(t){var e;return this.compare(this.heapArray[0],t)<0&&(e=Yn([this.heapArray[0],t],2),t=e[0],this.heapArray[0]=e[1],this._sortNodeDown(0)),t},n.prototype.remove=function(t,e){var i=this;if(e===void 0&&(e=n.defaultIsEqual),!this.heapArray.length)return!1;if(t===void 0)return this.pop(),!0;for(var s=[0];s.length;){var r=s.shift();if(e(this.heapArray[r],t))return r===0?this.pop():r===this.heapArray.length-1?this.heapArray.pop():(this.heapArray.splice(r,1,this.heapArray.pop()),this._sortNodeUp(r),this._sortNodeDown(r)),!0;if(this.compare(this.heapArray[r],t)<=0){var o=n.getChildrenIndexOf(r).filter(function(a){return a<i.heapArray.length});s.push.apply(s,oi([],Yn(o),!1))}}return!1},n.prototype.replace=function(t){var e=this.heapArray[0];return this.heapArray[0]=t,this._sortNodeDown(0),e},n.prototype.size=function(){return this.length},n.prototype.top=function(t){return t===void 0&&(t=1),this.heapArray.length===0||t<=0?[]:this.heapArray.length===1||t===1?[this.heapArray[0]]:t>=this.heapArray.length?oi([],Yn(this.heapArray),!1):this._topN_push(~~t)},n.prototype.toArray=function(){return oi([],Yn(this.heapArray),!1)},n.prototype.toString=function(){return this.heapArray.toString()},n.prototype.get=function(t){return this.heapArray[t]},n.prototype.getChildrenOf=function(t){var e=this;return n.getChildrenIndexOf(t).map(function(i){return e.heapArray[i]}).filter(function(i){return i!==void 0})},n.prototype.getParentOf=function(t){var e=n.getParentIndexOf(t);return this.heapArray[e]},n.prototype[Symbol.iterator]=function(){return GC(this,function(t){switch(t.label){case 0:return this.length?[4,this.pop()]:[3,2];case 1:return t.sent(),[3,0];case 2:return[2]}})},n.prototype.iterator=function(){return this.toArray()},n.prototype._applyLimit=function(){if(this._limit>0&&this._limit<this.heapArray.length)for(var t=this.heapArray.length-this._limit;t;)this.heapArray.pop(),--t},n.prototype._bottomN_push=function(t){var e=new n(this.compare);e.limit=t,e.heapArray=this.heapArray.slice(-t),e.init();for(var i=this.heapArray.length-1-t,s=n.getParentIndexOf(i),r=[],o=i;o>s;--o)r.push(o);for(var a=this.heapArray;r.length;){var o=r.shift();this.compare(a[o],e.peek())>0&&(e.replace(a[o]),o%2&&r.push(n.getParentIndexOf(o)))}return e.toArray()},n.prototype._moveNode=function(t,e){var i=this.heapArray[t];this.heapArray[t]=this.heapArray[e],this.heapArray[e]=i},n.prototype._sortNodeDown=function(t){for(var e=this.heapArray.length,i=t,s=this.heapArray[t],r=2*t+1;r<e;){var o=r+1,a=o>=e||this.compare(this.heapArray[r],this.heapArray[o])<0?r:o;if(this.compare(this.heapArray[a],s)<0)this.heapArray[t]=this.heapArray[a],t=a,r=2*t+1;else break}t!==i&&(this.heapArray[t]=s)},n.prototype._sortNodeUp=function(t){for(var e=this.heapArray[t],i=t;t>0;){var s=n.getParentIndexOf(t);if(this.compare(e,this.heapArray[s])<0)this.heapArray[t]=this.heapArray[s],t=s;else break}t!==i&&(this.heapArray[t]=e)},n.prototype._topN_push=function(t){var e=new n(this._invertedCompare);e.limit=t;for(var i=[0],s=this.heapArray;i.length;){var r=i.shift();r<s.length&&(e.length<t?(e.push(s[r]),i.push.apply(i,oi([],Yn(n.getChildrenIndexOf(r)),!1))):this.compare(s[r],e.peek())<0&&(e.replace(s[r]),i.push.apply(i,oi([],Yn(n.getChildrenIndexOf(r)),!1))))}return e.toArray()},n.prototype._topN_fill=function(t){var e=this.heapArray,i=new n(this._invertedCompare);i.limit=t,i.heapArray=e.slice(0,t),i.init();for(var s=n.getParentIndexOf(t-1)+1,r=[],o=s;o<t;++o)r.push.apply(r,oi([],Yn(n.getChildrenIndexOf(o).filter(function(a){return a<e.length})),!1));for((t-1)%2&&r.push(t);r.length;){var o=r.shift();o<e.length&&this.compare(e[o],i.peek())<0&&(i.replace(e[o]),r.push.apply(r,oi([],Yn(n.getChildrenIndexOf(o)),!1)))}return i.toArray()},n.prototype._topN_heap=function(t){for(var e=this.clone(),i=[],s=0;s<t;++s)i.push(e.pop());return i},n.prototype._topIdxOf=function(t){if(!t.length)return-1;for(var e=0,i=t[e],s=1;s<t.length;++s){var r=this.compare(t[s],i);r<0&&(e=s,i=t[s])}return e},n.prototype._topOf=function(){for(var t=[],e=0;e<arguments.length;e++)t[e]=arguments[e];var i=new n(this.compare);return i.init(t),i.peek()},n})();var mu=class{#t;#n=new Map;#r;#e=0;#s;constructor(t,e){this.#t=t,this.#r=e}async size(){return this.#s==null&&(this.#s=await this.#t.size()),this.#s}async read(t,e,i){let s=Number(e),r=this.#n.get(t);if(r!=null&&r.byteLength>=s)return r.byteLength===s?r:r.subarray(0,s);let o=await this.#t.read(t,e,i);if(this.#e+o.byteLength<=this.#r){let a=new Uint8Array(o);return this.#n.set(t,a),this.#e+=a.byteLength,a}return o}};var Dy=typeof DataView.prototype.getBigUint64=="function"?DataView.prototype.getBigUint64:function(n,t){let e=t===!0?this.getUint32(n,t):this.getUint32(n+4,t),i=t===!0?this.getUint32(n+4,t):this.getUint32(n,t);return BigInt(i)<<32n|BigInt(e)};var WC=new TextDecoder,On=class{#t;#n;offset;constructor(t,e=0){this.#t=t,this.#n=new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset=e}reset(t,e=0){this.#t=t,this.#n=new Uint8Array(t.buffer,t.byteOffset,t.byteLength),this.offset=e}bytesRemaining(){return this.#n.length-this.offset}uint8(){let t=this.#t.getUint8(this.offset);return this.offset+=1,t}uint16(){let t=this.#t.getUint16(this.offset,!0);return this.offset+=2,t}uint32(){let t=this.#t.getUint32(this.offset,!0);return this.offset+=4,t}uint64(){let t=Dy.call(this.#t,this.offset,!0);return this.offset+=8,t}string(){let t=this.uint32();if(t===0)return"";if(t>this.bytesRemaining())throw new Error(`String length ${t} exceeds bounds of buffer`);return WC.decode(this.u8ArrayBorrow(t))}keyValuePairs(t,e){let i=this.uint32();if(this.offset+i>this.#t.byteLength)throw new Error(`Key-value pairs length ${i} exceeds bounds of buffer`);let s=[],r=this.offset+i;try{for(;this.offset<r;)s.push([t(this),e(this)])}catch(o){throw new Error(`Error reading key-value pairs: ${o.message}`)}if(this.offset!==r)throw new Error(`Key-value pairs length (${this.offset-r+i}) greater than expected (${i})`);return s}map(t,e){let i=this.uint32();if(this.offset+i>this.#t.byteLength)throw new Error(`Map length ${i} exceeds bounds of buffer`);let s=new Map,r=this.offset+i;try{for(;this.offset<r;){let o=t(this),a=e(this),c=s.get(o);if(c!=null)throw new Error(`Duplicate key ${String(o)} (${String(c)} vs ${String(a)})`);s.set(o,a)}}catch(o){throw new Error(`Error reading map: ${o.message}`)}if(this.offset!==r)throw new Error(`Map length (${this.offset-r+i}) greater than expected (${i})`);return s}u8ArrayBorrow(t){let e=this.#n.subarray(this.offset,this.offset+t);return this.offset+=t,e}u8ArrayCopy(t){let e=this.#n.slice(this.offset,this.offset+t);return this.offset+=t,e}};var _n=Object.freeze([137,77,67,65,80,48,13,10]),ve;(function(n){n[n.MIN=1]="MIN",n[n.HEADER=1]="HEADER",n[n.FOOTER=2]="FOOTER",n[n.SCHEMA=3]="SCHEMA",n[n.CHANNEL=4]="CHANNEL",n[n.MESSAGE=5]="MESSAGE",n[n.CHUNK=6]="CHUNK",n[n.MESSAGE_INDEX=7]="MESSAGE_INDEX",n[n.CHUNK_INDEX=8]="CHUNK_INDEX",n[n.ATTACHMENT=9]="ATTACHMENT",n[n.ATTACHMENT_INDEX=10]="ATTACHMENT_INDEX",n[n.STATISTICS=11]="STATISTICS",n[n.METADATA=12]="METADATA",n[n.METADATA_INDEX=13]="METADATA_INDEX",n[n.SUMMARY_OFFSET=14]="SUMMARY_OFFSET",n[n.DATA_END=15]="DATA_END",n[n.MAX=15]="MAX"})(ve||(ve={}));function Ho(n){if(n.bytesRemaining()<_n.length)return;let t=n.u8ArrayBorrow(_n.length);if(!_n.every((e,i)=>e===t[i]))throw new Error(`Expected MCAP magic '${_n.map(e=>e.toString(16).padStart(2,"0")).join(" ")}', found '${Array.from(t,(e,i)=>t[i].toString(16).padStart(2,"0")).join(" ")}'`);return{specVersion:"0"}}function Ai(n,t=!1){if(n.bytesRemaining()<9)return;let i=n.offset,s=n.uint8(),r=n.uint64();if(r>Number.MAX_SAFE_INTEGER)throw new Error(`Record content length ${r} is too large`);let o=Number(r);if(n.bytesRemaining()<o){n.offset=i;return}let a;switch(s){case ve.HEADER:a=qC(n,o);break;case ve.FOOTER:a=YC(n,o);break;case ve.SCHEMA:a=ZC(n,o);break;case ve.CHANNEL:a=KC(n,o);break;case ve.MESSAGE:a=JC(n,o);break;case ve.CHUNK:a=jC(n,o);break;case ve.MESSAGE_INDEX:a=QC(n,o);break;case ve.CHUNK_INDEX:a=tR(n,o);break;case ve.ATTACHMENT:a=eR(n,o,t);break;case ve.ATTACHMENT_INDEX:a=nR(n,o);break;case ve.STATISTICS:a=iR(n,o);break;case ve.METADATA:a=sR(n,o);break;case ve.METADATA_INDEX:a=rR(n,o);break;case ve.SUMMARY_OFFSET:a=oR(n,o);break;case ve.DATA_END:a=aR(n,o);break;default:a=XC(n,o,s);break}return n.offset=i+9+o,a}function XC(n,t,e){let i=n.u8ArrayBorrow(t);return{type:"Unknown",opcode:e,data:i}}function qC(n,t){let e=n.offset,i=n.string(),s=n.string();return n.offset=e+t,{type:"Header",profile:i,library:s}}function YC(n,t){let e=n.offset,i=n.uint64(),s=n.uint64(),r=n.uint32();return n.offset=e+t,{type:"Footer",summaryStart:i,summaryOffsetStart:s,summaryCrc:r}}function ZC(n,t){let e=n.offset,i=n.uint16(),s=n.string(),r=n.string(),o=n.uint32(),a=n.offset;if(t-(a-e)<o)throw new Error(`Schema data length ${o} exceeds bounds of record`);let c=n.u8ArrayCopy(o);return n.offset=e+t,{type:"Schema",id:i,encoding:r,name:s,data:c}}function KC(n,t){let e=n.offset,i=n.uint16(),s=n.uint16(),r=n.string(),o=n.string(),a=n.map(c=>c.string(),c=>c.string());return n.offset=e+t,{type:"Channel",id:i,schemaId:s,topic:r,messageEncoding:o,metadata:a}}function JC(n,t){let i=n.uint16(),s=n.uint32(),r=n.uint64(),o=n.uint64(),a=n.u8ArrayCopy(t-22);return{type:"Message",channelId:i,sequence:s,logTime:r,publishTime:o,data:a}}function jC(n,t){let e=n.offset,i=n.uint64(),s=n.uint64(),r=n.uint64(),o=n.uint32(),a=n.string(),c=Number(n.uint64()),h=n.offset-e;if(c+h>t)throw new Error("Chunk records length exceeds remaining record size");let f=n.u8ArrayCopy(c);return n.offset=e+t,{type:"Chunk",messageStartTime:i,messageEndTime:s,compression:a,uncompressedSize:r,uncompressedCrc:o,records:f}}function QC(n,t){let e=n.offset,i=n.uint16(),s=n.keyValuePairs(r=>r.uint64(),r=>r.uint64());return n.offset=e+t,{type:"MessageIndex",channelId:i,records:s}}function tR(n,t){let e=n.offset,i=n.uint64(),s=n.uint64(),r=n.uint64(),o=n.uint64(),a=n.map(u=>u.uint16(),u=>u.uint64()),c=n.uint64(),l=n.string(),h=n.uint64(),f=n.uint64();return n.offset=e+t,{type:"ChunkIndex",messageStartTime:i,messageEndTime:s,chunkStartOffset:r,chunkLength:o,messageIndexOffsets:a,messageIndexLength:c,compression:l,compressedSize:h,uncompressedSize:f}}function eR(n,t,e){let i=n.offset,s=n.uint64(),r=n.uint64(),o=n.string(),a=n.string(),c=n.uint64();if(BigInt(n.offset)+c>Number.MAX_SAFE_INTEGER)throw new Error(`Attachment too large: ${c}`);if(n.offset+Number(c)+4>i+t)throw new Error(`Attachment data length ${c} exceeds bounds of record`);let l=n.u8ArrayCopy(Number(c)),h=n.offset-i,f=n.uint32();if(e&&f!==0){n.offset=i;let u=n.u8ArrayBorrow(h),d=Os(u);if(n.offset=i+h+4,d!==f)throw new Error(`Attachment CRC32 mismatch: expected ${f}, actual ${d}`)}return n.offset=i+t,{type:"Attachment",logTime:s,createTime:r,name:o,mediaType:a,data:l}}function nR(n,t){let e=n.offset,i=n.uint64(),s=n.uint64(),r=n.uint64(),o=n.uint64(),a=n.uint64(),c=n.string(),l=n.string();return n.offset=e+t,{type:"AttachmentIndex",offset:i,length:s,logTime:r,createTime:o,dataSize:a,name:c,mediaType:l}}function iR(n,t){let e=n.offset,i=n.uint64(),s=n.uint16(),r=n.uint32(),o=n.uint32(),a=n.uint32(),c=n.uint32(),l=n.uint64(),h=n.uint64(),f=n.map(u=>u.uint16(),u=>u.uint64());return n.offset=e+t,{type:"Statistics",messageCount:i,schemaCount:s,channelCount:r,attachmentCount:o,metadataCount:a,chunkCount:c,messageStartTime:l,messageEndTime:h,channelMessageCounts:f}}function sR(n,t){let e=n.offset,i=n.string(),s=n.map(r=>r.string(),r=>r.string());return n.offset=e+t,{type:"Metadata",metadata:s,name:i}}function rR(n,t){let e=n.offset,i=n.uint64(),s=n.uint64(),r=n.string();return n.offset=e+t,{type:"MetadataIndex",offset:i,length:s,name:r}}function oR(n,t){let e=n.offset,i=n.uint8(),s=n.uint64(),r=n.uint64();return n.offset=e+t,{type:"SummaryOffset",groupOpcode:i,groupStart:s,groupLength:r}}function aR(n,t){let e=n.offset,i=n.uint32();return n.offset=e+t,{type:"DataEnd",dataSectionCrc:i}}function Ny(n,t,e){let i=0,s=n.length;if(s===0)return 0;let r=e(t);for(;i<s;){let o=i+s>>>1;e(n[o][0])<r?i=o+1:s=o}return s}function Oy(n,t,e){let i=0,s=n.length;if(s===0)return 0;let r=e(t);for(;i<s;){let o=i+s>>>1;e(n[o][0])<=r?i=o+1:s=o}return s}var gu=class{chunkIndex;#t;#n;#r;#e;#s;#i;#a=0;constructor(t){if(this.chunkIndex=t.chunkIndex,this.#t=t.relevantChannels,this.#n=t.startTime,this.#r=t.endTime,this.#e=t.reverse,this.#s=t.readFullMessageIndexRange??!1,this.chunkIndex.messageIndexLength===0n&&(this.chunkIndex.messageStartTime!==0n||this.chunkIndex.messageEndTime!==0n))throw new Error("Encountered a chunk index without message indexes and non-zero start and end times")}compare(t){if(this.#e!==t.#e)throw new Error("Cannot compare a reversed ChunkCursor to a non-reversed ChunkCursor");let e=Number(this.#o()-t.#o());return e===0&&(e=Number(this.chunkIndex.chunkStartOffset-t.chunkIndex.chunkStartOffset)),this.#e?-e:e}hasMoreMessages(){if(this.#i==null)throw new Error("loadMessageIndexes() must be called before hasMore()");return this.#a<this.#i.length}popMessage(){if(this.#i==null)throw new Error("loadMessageIndexes() must be called before popMessage()");if(this.#a>=this.#i.length)throw new Error(`Unexpected popMessage() call when no more messages are available, in chunk at offset ${this.chunkIndex.chunkStartOffset}`);return this.#i[this.#a++]}hasMessageIndexes(){return this.#i!=null}async loadMessageIndexes(t,e){let i=this.#e,s,r,o=this.#s;for(let[S,C]of this.chunkIndex.messageIndexOffsets)(s==null||C<s)&&(s=C),(o||!this.#t||this.#t.has(S))&&(r==null||C<r)&&(r=C);if(s==null||r==null){this.#i=[];return}let a=s+this.chunkIndex.messageIndexLength,c=await t.read(r,a-r,e),l=new DataView(c.buffer,c.byteOffset,c.byteLength),h=new On(l),f=[],u;for(;u=Ai(h,!0);)u.type==="MessageIndex"&&(u.records.length===0||this.#t&&!this.#t.has(u.channelId)||f.push(u.records));if(h.bytesRemaining()!==0)throw new Error(`${h.bytesRemaining()} bytes remaining in message index section`);if(this.#i=f.flat().sort(([S,C],[E,y])=>{let w=Number(S-E);return w===0&&(w=Number(C-y)),w}),i&&this.#i.reverse(),this.#i.length===0)return;let[d]=this.#i[0];if(d<this.chunkIndex.messageStartTime)throw new Error(`Chunk at offset ${this.chunkIndex.chunkStartOffset} contains a message with logTime (${d}) earlier than chunk messageStartTime (${this.chunkIndex.messageStartTime})`);let[p]=this.#i[this.#i.length-1];if(p>this.chunkIndex.messageEndTime)throw new Error(`Chunk at offset ${this.chunkIndex.chunkStartOffset} contains a message with logTime (${p}) later than chunk messageEndTime (${this.chunkIndex.messageEndTime})`);let _=i?this.#r:this.#n,m=i?this.#n:this.#r,g=i?S=>-S:S=>S,v,T;_!=null&&(v=Ny(this.#i,_,g)),m!=null&&(T=Oy(this.#i,m,g)),(v!=null||T!=null)&&(this.#i=this.#i.slice(v,T))}#o(){return this.#i!=null&&this.#i.length>0&&this.#a<this.#i.length?this.#i[this.#a][0]:this.#e?this.chunkIndex.messageEndTime:this.chunkIndex.messageStartTime}};var Vo=class n{chunkIndexes;attachmentIndexes;metadataIndexes=[];channelsById;schemasById;statistics;summaryOffsetsByOpcode;header;footer;dataEndOffset;dataSectionCrc;#t;#n;#r;#e;#s;#i;#a;constructor(t){this.#t=t.readable,this.chunkIndexes=t.chunkIndexes,this.attachmentIndexes=t.attachmentIndexes,this.metadataIndexes=t.metadataIndexes,this.statistics=t.statistics,this.#r=t.decompressHandlers,this.channelsById=t.channelsById,this.schemasById=t.schemasById,this.summaryOffsetsByOpcode=t.summaryOffsetsByOpcode,this.header=t.header,this.footer=t.footer,this.dataEndOffset=t.dataEndOffset,this.dataSectionCrc=t.dataSectionCrc;let e=t.messageIndexCacheSizeBytes??0;this.#n=e>0?new mu(this.#t,e):this.#t;for(let i of t.chunkIndexes)(this.#e==null||i.messageStartTime<this.#e)&&(this.#e=i.messageStartTime),(this.#s==null||i.messageEndTime>this.#s)&&(this.#s=i.messageEndTime);for(let i of t.attachmentIndexes)(this.#i==null||i.logTime<this.#i)&&(this.#i=i.logTime),(this.#a==null||i.logTime>this.#a)&&(this.#a=i.logTime)}#o(t){return new Error(`${t} [library=${this.header.library}]`)}static async Initialize({readable:t,decompressHandlers:e,messageIndexCacheSizeBytes:i,readOptions:s}){let r=await t.size(),o,a;{let B=await t.read(0n,BigInt(_n.length+1+8),s),F=new DataView(B.buffer,B.byteOffset,B.byteLength);Ho(new On(F));let R=F.getBigUint64(_n.length+1,!0),U=1n+8n+R,X=await t.read(BigInt(_n.length),U,s);a=BigInt(_n.length)+U;let G=new On(new DataView(X.buffer,X.byteOffset,X.byteLength)),ct=Ai(G,!0);if(ct?.type!=="Header")throw new Error(`Unable to read header at beginning of file; found ${ct?.type??"nothing"}`);if(G.bytesRemaining()!==0)throw new Error(`${G.bytesRemaining()} bytes remaining after parsing header`);o=ct}function c(B){return new Error(`${B} [library=${o.library}]`)}let l,h;{let B=BigInt(_n.length+1+8+4+4),F=BigInt(29+_n.length);if(r<B+F)throw c(`File size (${r}) is too small to be valid MCAP`);l=r-F;let R=await t.read(l,F,s);h=new DataView(R.buffer,R.byteOffset,R.byteLength)}try{Ho(new On(h,h.byteLength-_n.length))}catch(B){throw c(B.message)}let f;{let B=new On(h),F=Ai(B,!0);if(F?.type!=="Footer")throw c(`Unable to read footer from end of file (offset ${l}); found ${F?.type??"nothing"}`);if(B.bytesRemaining()!==_n.length)throw c(`${B.bytesRemaining()-_n.length} bytes remaining after parsing footer`);f=F}if(f.summaryStart===0n)throw c("File is not indexed");let u=new Uint8Array(25);u.set(new Uint8Array(h.buffer,h.byteOffset,u.byteLength));let d=1n+8n+4n,p=f.summaryStart-d;if(p<a)throw c(`Expected DataEnd position (summary start ${f.summaryStart} - ${d} = ${p}) to be after Header end offset (${a})`);let _=await t.read(p,l-p,s);if(f.summaryCrc!==0){let B=du();if(B=fl(B,_.subarray(Number(d))),B=fl(B,u),B=pu(B),B!==f.summaryCrc)throw c(`Incorrect summary CRC ${B} (expected ${f.summaryCrc})`)}let m=new DataView(_.buffer,_.byteOffset,_.byteLength),g=new On(m),v=new Map,T=new Map,S=[],C=[],E=[],y=new Map,w,V,N=!0,L;for(;L=Ai(g,!0);){if(N&&L.type!=="DataEnd")throw c(`Expected DataEnd record to precede summary section, but found ${L.type}`);switch(N=!1,L.type){case"Schema":T.set(L.id,L);break;case"Channel":v.set(L.id,L);break;case"ChunkIndex":S.push(L);break;case"AttachmentIndex":C.push(L);break;case"MetadataIndex":E.push(L);break;case"Statistics":if(w)throw c("Duplicate Statistics record");w=L;break;case"SummaryOffset":y.set(L.groupOpcode,L);break;case"DataEnd":V=L.dataSectionCrc===0?void 0:L.dataSectionCrc;break;case"Header":case"Footer":case"Message":case"Chunk":case"MessageIndex":case"Attachment":case"Metadata":throw c(`${L.type} record not allowed in index section`);case"Unknown":break}}if(g.bytesRemaining()!==0)throw c(`${g.bytesRemaining()} bytes remaining in index section`);return new n({readable:t,chunkIndexes:S,attachmentIndexes:C,metadataIndexes:E,statistics:w,decompressHandlers:e,channelsById:v,schemasById:T,summaryOffsetsByOpcode:y,header:o,footer:f,dataEndOffset:p,dataSectionCrc:V,messageIndexCacheSizeBytes:i})}async*readMessages(t={}){let{topics:e,startTime:i=this.#e,endTime:s=this.#s,reverse:r=!1,validateCrcs:o,readOptions:a}=t;if(i==null||s==null)return;let c;if(e){c=new Set;for(let _ of this.channelsById.values())e.includes(_.topic)&&c.add(_.id)}let l=new Ly((_,m)=>_.compare(m)),h=!0,f,u=this.#n!==this.#t;for(let _ of this.chunkIndexes)_.messageStartTime<=s&&_.messageEndTime>=i&&(l.push(new gu({chunkIndex:_,relevantChannels:c,startTime:i,endTime:s,reverse:r,readFullMessageIndexRange:u})),h&&f!=null&&(h=_.messageStartTime>=f),f=_.messageEndTime);let d=new Map,p=new On(new DataView(new ArrayBuffer(0)));for(let _;_=l.peek();){if(!_.hasMessageIndexes()){await _.loadMessageIndexes(this.#n,a),_.hasMoreMessages()?l.replace(_):l.pop();continue}let m=d.get(_.chunkIndex.chunkStartOffset);m||(m=await this.#l(_.chunkIndex,{validateCrcs:o??!0,readOptions:a}),d.set(_.chunkIndex.chunkStartOffset,m));let[g,v]=_.popMessage();if(v>=BigInt(m.byteLength))throw this.#o(`Message offset beyond chunk bounds (log time ${g}, offset ${v}, chunk data length ${m.byteLength}) in chunk at offset ${_.chunkIndex.chunkStartOffset}`);p.reset(m,Number(v));let T=Ai(p,o??!0);if(!T)throw this.#o(`Unable to parse record at offset ${v} in chunk at offset ${_.chunkIndex.chunkStartOffset}`);if(T.type!=="Message")throw this.#o(`Unexpected record type ${T.type} in message index (time ${g}, offset ${v} in chunk at offset ${_.chunkIndex.chunkStartOffset})`);if(T.logTime!==g)throw this.#o(`Message log time ${T.logTime} did not match message index entry (${g} at offset ${v} in chunk at offset ${_.chunkIndex.chunkStartOffset})`);yield T,_.hasMoreMessages()?h||l.replace(_):(l.pop(),d.delete(_.chunkIndex.chunkStartOffset))}}async*readMetadata(t={}){let{name:e,readOptions:i}=t;for(let s of this.metadataIndexes){if(e!=null&&s.name!==e)continue;let r=await this.#t.read(s.offset,s.length,i),o=new On(new DataView(r.buffer,r.byteOffset,r.byteLength)),a=Ai(o,!1);if(a?.type!=="Metadata")throw this.#o(`Metadata data at offset ${s.offset} does not point to metadata record (found ${String(a?.type)})`);yield a}}async*readAttachments(t={}){let{name:e,mediaType:i,startTime:s=this.#i,endTime:r=this.#a,validateCrcs:o,readOptions:a}=t;if(!(s==null||r==null))for(let c of this.attachmentIndexes){if(e!=null&&c.name!==e||i!=null&&c.mediaType!==i||c.logTime>r||c.logTime<s)continue;let l=await this.#t.read(c.offset,c.length,a),h=new On(new DataView(l.buffer,l.byteOffset,l.byteLength)),f=Ai(h,o??!0);if(f?.type!=="Attachment")throw this.#o(`Attachment data at offset ${c.offset} does not point to attachment record (found ${String(f?.type)})`);yield f}}async#l(t,e){let i=await this.#t.read(t.chunkStartOffset,t.chunkLength,e?.readOptions),s=new On(new DataView(i.buffer,i.byteOffset,i.byteLength)),r=Ai(s,e?.validateCrcs??!0);if(r?.type!=="Chunk")throw this.#o(`Chunk start offset ${t.chunkStartOffset} does not point to chunk record (found ${String(r?.type)})`);let o=r,a=o.records;if(o.compression!==""&&a.byteLength>0){let c=this.#r?.[o.compression];if(!c)throw this.#o(`Unsupported compression ${o.compression}`);a=c(a,o.uncompressedSize)}if(o.uncompressedCrc!==0&&e?.validateCrcs!==!1){let c=Os(a);if(c!==o.uncompressedCrc)throw this.#o(`Incorrect chunk CRC ${c} (expected ${o.uncompressedCrc})`)}return new DataView(a.buffer,a.byteOffset,a.byteLength)}};var Go=class{#t=new ArrayBuffer(_n.length*2);#n=new DataView(this.#t,0,0);#r=new On(this.#n);#e;#s;#i;#a;#o=!1;#l=this.#u();#c=new Map;constructor({includeChunks:t=!1,decompressHandlers:e={},validateCrcs:i=!0,noMagicPrefix:s=!1}={}){this.#s=t,this.#e=e,this.#i=i,this.#a=s}done(){return this.#o}bytesRemaining(){return this.#r.bytesRemaining()}append(t){if(this.#o)throw new Error("Already done reading");this.#h(t)}#h(t){let e=this.#r.offset,i=this.#n.byteLength-e,s=i+t.byteLength;if(s<=this.#t.byteLength)if(this.#n.byteOffset+this.#n.byteLength+t.byteLength<=this.#t.byteLength)new Uint8Array(this.#t,this.#n.byteOffset).set(t,this.#n.byteLength),this.#n=new DataView(this.#t,this.#n.byteOffset,this.#n.byteLength+t.byteLength),this.#r.reset(this.#n,this.#r.offset);else{let r=new Uint8Array(this.#t,this.#n.byteOffset+e,i),o=new Uint8Array(this.#t);o.set(r,0),o.set(t,r.byteLength),this.#n=new DataView(this.#t,0,r.byteLength+t.byteLength),this.#r.reset(this.#n)}else{this.#t=new ArrayBuffer(s*2);let r=new Uint8Array(this.#t),o=new Uint8Array(this.#n.buffer,this.#n.byteOffset+e,i);r.set(o,0),r.set(t,o.byteLength),this.#n=new DataView(this.#t,0,o.byteLength+t.byteLength),this.#r.reset(this.#n)}}nextRecord(){if(this.#o)return;let t=this.#l.next();if(t.value?.type==="Channel"){let e=this.#c.get(t.value.id);if(this.#c.set(t.value.id,t.value),e&&!lR(e,t.value))throw new Error(`Channel record for id ${t.value.id} (topic: ${t.value.topic}) differs from previous channel record of the same id.`)}else if(t.value?.type==="Message"){let e=t.value.channelId;if(!this.#c.get(e))throw new Error(`Encountered message on channel ${e} without prior channel record`)}return t.done===!0&&(this.#o=!0),t.value}*#u(){if(!this.#a){let i;for(;i=Ho(this.#r),!i;)yield}let t;function e(i){return new Error(`${i} ${t?`[library=${t.library}]`:"[no header]"}`)}for(;;){let i;for(;i=Ai(this.#r,this.#i),!i;)yield;switch(i.type){case"Header":if(t)throw new Error(`Duplicate Header record: library=${t.library} profile=${t.profile} vs. library=${i.library} profile=${i.profile}`);t=i,yield i;break;case"Unknown":case"Schema":case"Channel":case"Message":case"MessageIndex":case"ChunkIndex":case"Attachment":case"AttachmentIndex":case"Statistics":case"Metadata":case"MetadataIndex":case"SummaryOffset":case"DataEnd":yield i;break;case"Chunk":{this.#s&&(yield i);let s=i.records;if(i.compression!==""&&s.byteLength>0){let c=this.#e[i.compression];if(!c)throw e(`Unsupported compression ${i.compression}`);s=c(s,i.uncompressedSize)}if(this.#i&&i.uncompressedCrc!==0){let c=Os(s);if(c!==i.uncompressedCrc)throw e(`Incorrect chunk CRC ${c} (expected ${i.uncompressedCrc})`)}let r=new DataView(s.buffer,s.byteOffset,s.byteLength),o=new On(r),a;for(;a=Ai(o,this.#i);)switch(a.type){case"Header":case"Footer":case"Chunk":case"MessageIndex":case"ChunkIndex":case"Attachment":case"AttachmentIndex":case"Statistics":case"Metadata":case"MetadataIndex":case"SummaryOffset":case"DataEnd":throw e(`${a.type} record not allowed inside a chunk`);case"Unknown":case"Schema":case"Channel":case"Message":yield a;break}if(o.bytesRemaining()!==0)throw e(`${o.bytesRemaining()} bytes remaining in chunk`);break}case"Footer":try{let s;for(;s=Ho(this.#r),!s;)yield}catch(s){throw e(s.message)}if(this.#r.bytesRemaining()!==0)throw e(`${this.#r.bytesRemaining()} bytes remaining after MCAP footer and trailing magic`);return i}}}};function lR(n,t){if(!(n.id===t.id&&n.messageEncoding===t.messageEncoding&&n.schemaId===t.schemaId&&n.topic===t.topic&&n.metadata.size===t.metadata.size))return!1;for(let[e,i]of n.metadata.entries()){let s=t.metadata.get(e);if(i!==s)return!1}return!0}var _u=class{#t=new Uint8Array(4096);#n;#r=new TextEncoder;#e=0;constructor(){this.#n=new DataView(this.#t.buffer)}get length(){return this.#e}get buffer(){return this.#t.slice(0,this.#e)}bufferView(t,e){return new Uint8Array(this.#t.buffer,t,e)}int8(t){return this.#s(1),this.#n.setInt8(this.#e,t),this.#e+=1,this}uint8(t){return this.#s(1),this.#n.setUint8(this.#e,t),this.#e+=1,this}int16(t){return this.#s(2),this.#n.setInt16(this.#e,t,!0),this.#e+=2,this}uint16(t){return this.#s(2),this.#n.setUint16(this.#e,t,!0),this.#e+=2,this}int32(t){return this.#s(4),this.#n.setInt32(this.#e,t,!0),this.#e+=4,this}uint32(t){return this.#s(4),this.#n.setUint32(this.#e,t,!0),this.#e+=4,this}int64(t){return this.#s(8),this.#n.setBigInt64(this.#e,t,!0),this.#e+=8,this}uint64(t){return this.#s(8),this.#n.setBigUint64(this.#e,t,!0),this.#e+=8,this}string(t){let e=this.#r.encode(t);return this.#s(e.byteLength+4),this.uint32(e.length),this.#t.set(e,this.#e),this.#e+=e.length,this}bytes(t){return this.#s(t.byteLength),this.#t.set(t,this.#e),this.#e+=t.length,this}tupleArray(t,e,i){let s=this.#e;this.uint32(0);for(let[a,c]of i)t.call(this,a),e.call(this,c);let r=this.#e;this.#e=s;let o=r-s-4;return this.uint32(o),this.#e=r,this}seek(t){return this.#i(t),this.#e=t,this}reset(){return this.#e=0,this}#s(t){this.#i(this.#e+t)}#i(t){if(t>this.#t.byteLength){let e=Math.max(this.#t.byteLength*1.5,t),i=new Uint8Array(e);i.set(this.#t),this.#t=i,this.#n=new DataView(this.#t.buffer)}}};var ur=class{options;#t=new _u;constructor(t){this.options=t}get length(){return this.#t.length}get buffer(){return this.#t.buffer}reset(){this.#t.reset()}writeMagic(){this.#t.bytes(new Uint8Array(_n))}writeHeader(t){this.#t.uint8(ve.HEADER);let e=this.#t.length;this.#t.uint64(0n).string(t.profile).string(t.library),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeFooter(t){return this.#t.uint8(ve.FOOTER).uint64(20n).uint64(t.summaryStart).uint64(t.summaryOffsetStart).uint32(t.summaryCrc),20n}writeSchema(t){this.#t.uint8(ve.SCHEMA);let e=this.#t.length;this.#t.uint64(0n).uint16(t.id).string(t.name).string(t.encoding).uint32(t.data.byteLength).bytes(t.data),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeChannel(t){this.#t.uint8(ve.CHANNEL);let e=this.#t.length;this.#t.uint64(0n).uint16(t.id).uint16(t.schemaId).string(t.topic).string(t.messageEncoding).tupleArray(s=>this.#t.string(s),s=>this.#t.string(s),t.metadata),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeMessage(t){this.#t.uint8(ve.MESSAGE);let e=this.#t.length;this.#t.uint64(0n).uint16(t.channelId).uint32(t.sequence).uint64(t.logTime).uint64(t.publishTime).bytes(t.data);let i=this.#t.length;this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i)}writeAttachment(t){this.#t.uint8(ve.ATTACHMENT);let e=this.#t.length;this.#t.uint64(0n);let i=this.#t.length;this.#t.uint64(t.logTime).uint64(t.createTime).string(t.name).string(t.mediaType).uint64(BigInt(t.data.byteLength)).bytes(t.data),this.#t.uint32(Os(this.#t.bufferView(i,this.#t.length-i))),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let s=this.#t.length;return this.#t.seek(e).uint64(BigInt(s-e-8)).seek(s),BigInt(s-e+1)}writeAttachmentIndex(t){this.#t.uint8(ve.ATTACHMENT_INDEX);let e=this.#t.length;this.#t.uint64(0n).uint64(t.offset).uint64(t.length).uint64(t.logTime).uint64(t.createTime).uint64(t.dataSize).string(t.name).string(t.mediaType),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeChunk(t){this.#t.uint8(ve.CHUNK);let e=this.#t.length;this.#t.uint64(0n).uint64(t.messageStartTime).uint64(t.messageEndTime).uint64(t.uncompressedSize).uint32(t.uncompressedCrc).string(t.compression).uint64(BigInt(t.records.byteLength)).bytes(t.records);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeChunkIndex(t){this.#t.uint8(ve.CHUNK_INDEX);let e=this.#t.length;this.#t.uint64(0n).uint64(t.messageStartTime).uint64(t.messageEndTime).uint64(t.chunkStartOffset).uint64(t.chunkLength).uint32(t.messageIndexOffsets.size*10);for(let[s,r]of t.messageIndexOffsets)this.#t.uint16(s).uint64(r);this.#t.uint64(t.messageIndexLength).string(t.compression).uint64(t.compressedSize).uint64(t.uncompressedSize),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeMessageIndex(t){this.#t.uint8(ve.MESSAGE_INDEX);let e=this.#t.length,i=t.records.length*16;this.#t.uint64(0n).uint16(t.channelId).uint32(i);for(let r of t.records)this.#t.uint64(r[0]).uint64(r[1]);this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let s=this.#t.length;return this.#t.seek(e).uint64(BigInt(s-e-8)).seek(s),BigInt(s-e+1)}writeMetadata(t){this.#t.uint8(ve.METADATA);let e=this.#t.length;this.#t.uint64(0n).string(t.name).tupleArray(s=>this.#t.string(s),s=>this.#t.string(s),t.metadata),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeMetadataIndex(t){this.#t.uint8(ve.METADATA_INDEX);let e=this.#t.length;this.#t.uint64(0n).uint64(t.offset).uint64(t.length).string(t.name),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeSummaryOffset(t){this.#t.uint8(ve.SUMMARY_OFFSET);let e=this.#t.length;this.#t.uint64(0n).uint8(t.groupOpcode).uint64(t.groupStart).uint64(t.groupLength),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeStatistics(t){this.#t.uint8(ve.STATISTICS);let e=this.#t.length;this.#t.uint64(0n).uint64(t.messageCount).uint16(t.schemaCount).uint32(t.channelCount).uint32(t.attachmentCount).uint32(t.metadataCount).uint32(t.chunkCount).uint64(t.messageStartTime).uint64(t.messageEndTime).tupleArray(s=>this.#t.uint16(s),s=>this.#t.uint64(s),t.channelMessageCounts),this.options?.padRecords===!0&&this.#t.uint8(1).uint8(255).uint8(255);let i=this.#t.length;return this.#t.seek(e).uint64(BigInt(i-e-8)).seek(i),BigInt(i-e+1)}writeDataEnd(t){return this.#t.uint8(ve.DATA_END).uint64(4n).uint32(t.dataSectionCrc),4n}};var cR="2.2.2",hR=`mcap-typescript/${cR}`;function Uy(n,t){let e=new DataView(n.buffer,n.byteOffset,n.byteLength),i=new Uint8Array(t),s=fR(e),r=dR(s),o=0;for(;;){let a=e.getUint32(r,!0);if(r+=4,a===0)break;let c=a&2147483647,l=n.subarray(r,r+c);if(l.length!==c)throw new Error("LZ4: the last block is cut");o=a&2147483648?Fy(l,i,o):pR(l,i,o),r+=c+(s.hasBlockSum?4:0)}if(o!==t)throw new Error(`LZ4: ${o} bytes where ${t} are expected`);return i}function fR(n){if(n.getUint32(0,!0)!==407708164)throw new Error("LZ4: not a frame");let t=n.getUint8(4);if(t>>6!==1)throw new Error("LZ4: a version that is not known");if(t&1)throw new Error("LZ4: a dictionary is needed");return{hasBlockSum:(t&16)!==0,hasSize:(t&8)!==0}}function dR({hasSize:n}){return 6+(n?8:0)+1}function Fy(n,t,e){if(e+n.length>t.length)throw new Error("LZ4: more bytes than expected");return t.set(n,e),e+n.length}function pR(n,t,e){let i=0,s=r=>{if(r!==15)return r;let o;do{if(i>=n.length)throw new Error("LZ4: a length is cut");r+=o=n[i++]}while(o===255);return r};for(;i<n.length;){let r=n[i++],o=s(r>>4);if(i+o>n.length)throw new Error("LZ4: literals are cut");if(e=Fy(n.subarray(i,i+o),t,e),i+=o,i===n.length)break;if(i+2>n.length)throw new Error("LZ4: an offset is cut");let a=n[i]|n[i+1]<<8;i+=2,e=mR(t,e,a,s(r&15)+4)}return e}function mR(n,t,e,i){if(e===0||e>t)throw new Error("LZ4: a match before the start");if(t+i>n.length)throw new Error("LZ4: more bytes than expected");if(e>=i)n.copyWithin(t,t-e,t-e+i);else for(let s=0;s<i;s++)n[t+s]=n[t+s-e];return t+i}var gR=/(\/skin|\/links|\/tf_static)$/,_R={"dermatome_msgs/msg/Image":"/image","dermatome_msgs/msg/ContactArray":"/contacts"},cp=[137,77,67,65,80,48,13,10],Wo=9,yR=6,xR=32,vR=6,SR={lz4:(n,t)=>Uy(n,Number(t))};async function By(n,t,e=()=>{}){await wR(n);let i=await MR(n)??await ER(n,e),s=new hp(n,t,i,"*");return s.check(),i.start=await s.firstFrame(),s.hasRobot?s:s.of(s.spaces[0])}var hp=class n{constructor(t,e,i,s){let{chunks:r,schemas:o,channels:a,isCut:c}=i;Object.assign(this,{blob:t,name:e,index:i,space:s,chunks:r,schemas:o,isCut:c}),this.chunks.sort((h,f)=>Number(h.start-f.start));let l=[...a].map(([h,f])=>[h,{...f,topic:Wu(f,s,this.spaces)}]);this.channels=new Map(l.filter(([,{topic:h}])=>h!==void 0)),this.held=new Map,this.heldLasting=new Map}get spaces(){return bR(this.index)}get hasRobot(){return Gu([...this.index.channels.values()])}get isWhole(){return this.space==="*"}get topics(){return this.isWhole?[...this.channels.values()].map(({topic:t})=>t):Object.values(Ln)}of(t){return new n(this.blob,this.name,this.index,t)}get start(){return this.index.start}get end(){return this.chunks.reduce((t,e)=>e.end>t?e.end:t,this.start)}async firstFrame(){let{start:t}=this.chunks[0];return await this.neighbour(t-1n,!0).catch(()=>{})??t}get duration(){return Number(this.end-this.start)/1e9}check(){if(this.chunks.length===0)throw new Error("The recording is empty: it was cut before its first chunk was written, or nothing was recorded.");if(this.spaces.length===0)throw new Error("The file holds no images or contacts of a skin (no topic /dermatome/image): another program wrote it.")}async at(t,e=this.topics){return(await Promise.all(e.map(s=>this.lastOf(s,t)))).filter(s=>s!==void 0)}async lastOf(t,e){if(gR.test(t))return this.lastingOf(t,e);for(let i of this.chunksOf(t).filter(({start:s})=>s<=e).reverse()){let r=((await this.messagesOf(i)).get(t)??[]).findLast(({logTime:o})=>o<=e);if(r)return r}}async lastingOf(t,e){this.heldLasting.has(t)||this.heldLasting.set(t,this.allOf(t));let i=await this.heldLasting.get(t);return i.findLast(({logTime:s})=>s<=e)??i[0]}async allOf(t){let e=[];for(let i of this.chunksOf(t))e.push(...(await this.messagesOf(i)).get(t)??[]);return e}async neighbour(t,e){return(await Promise.all(this.frameTopics.map(r=>this.neighbourOf(r,t,e)))).filter(r=>r!==void 0).sort((r,o)=>Number(r-o)).at(e?0:-1)}get frameTopics(){let t=i=>this.topics.filter(s=>s.endsWith(i)&&this.chunksOf(s).length>0),e=t("/image");return e.length>0?e:t("/contacts")}async neighbourOf(t,e,i){let s=this.chunksOf(t).filter(({start:r,end:o})=>i?o>e:r<e);for(let r of i?s:s.reverse()){let o=(await this.messagesOf(r)).get(t)??[],a=i?o.find(({logTime:c})=>c>e):o.findLast(({logTime:c})=>c<e);if(a)return a.logTime}}async*walk(t){for(let e of this.chunks){let i=await(this.held.get(e)??this.readMessages(e));yield t.flatMap(s=>i.get(s)??[]).sort((s,r)=>Number(s.logTime-r.logTime))}}channelsOf(t){return[...this.channels.values()].filter(e=>t.includes(e.topic))}chunksOf(t){let e=this.channelsOf([t]).map(i=>i.id);return this.chunks.filter(i=>e.some(s=>i.channelIds.has(s)))}messagesOf(t){let i=this.held.get(t)??this.readMessages(t);return this.held.delete(t),this.held.set(t,i),this.held.size>vR&&this.held.delete(this.held.keys().next().value),i}async readMessages(t){let e=new Map;for(let i of await this.recordsOf(t)){if(i.type!=="Message")continue;let s=this.channels.get(i.channelId);if(!s)continue;let{topic:r,schemaId:o}=s,a={topic:r,schema:this.schemaText(o),bytes:i.data,logTime:i.logTime};e.has(r)||e.set(r,[]),e.get(r).push(a)}for(let i of e.values())i.sort((s,r)=>Number(s.logTime-r.logTime));return e}async recordsOf({offset:t,length:e}){let i=new ur;for(let s of this.schemas.values())i.writeSchema(s);for(let s of this.index.channels.values())i.writeChannel(s);return ky([i.buffer,await dl(this.blob,t,e)])}schemaText(t){return new TextDecoder().decode(this.schemas.get(t)?.data)}};function bR({channels:n,schemas:t}){let e=[...n.values()].flatMap(({topic:i,schemaId:s})=>{let r=_R[t.get(s)?.name];return r&&i.endsWith(r)?[i.slice(1,-r.length)]:[]});return[...new Set(e)]}async function wR(n){if(n.size===0)throw new Error("The file is empty.");let t=await dl(n,0,Math.min(n.size,cp.length));if(cp.some((e,i)=>t[i]!==e))throw new Error("The file is not MCAP. Recordings of `dermatome view` end in .mcap.")}async function MR(n){let t={size:async()=>BigInt(n.size),read:(e,i)=>dl(n,Number(e),Number(i))};try{let e=await Vo.Initialize({readable:t}),s=e.chunkIndexes.filter(o=>o.messageIndexOffsets.size>0).map(o=>({offset:Number(o.chunkStartOffset),length:Number(o.chunkLength),start:o.messageStartTime,end:o.messageEndTime,channelIds:new Set(o.messageIndexOffsets.keys())}));return e.channelsById.size>0&&s.every(({channelIds:o})=>o.size>0)?{chunks:s,schemas:e.schemasById,channels:e.channelsById,isCut:!1}:void 0}catch{return}}async function ER(n,t){let e={chunks:[],schemas:new Map,channels:new Map,isCut:!0},i=cp.length;for(;i+Wo<=n.size;){let s=zy(await dl(n,i,Wo)),r=Wo+Number(s.getBigUint64(1,!0));if(i+r>n.size||s.getUint8(0)===yR&&!await AR(e,n,i,r))break;i+=r,t(i/n.size)}return e}async function AR(n,t,e,i){let s=await dl(t,e,i);if(i<Wo+xR)return!1;let r=zy(s.subarray(Wo,Wo+16)),o=new ur;for(let h of n.channels.values())o.writeChannel(h);let a=new Set;try{for(let h of ky([o.buffer,s]))h.type==="Schema"&&n.schemas.set(h.id,h),h.type==="Channel"&&n.channels.set(h.id,h),h.type==="Message"&&a.add(h.channelId)}catch{return!1}let[c,l]=[r.getBigUint64(0,!0),r.getBigUint64(8,!0)];return a.size>0&&n.chunks.push({offset:e,length:i,start:c,end:l,channelIds:a}),!0}function ky(n){let t=new Go({noMagicPrefix:!0,decompressHandlers:SR});for(let i of n)t.append(i);let e=[];for(let i;i=t.nextRecord();)e.push(i);return e}async function dl(n,t,e){return new Uint8Array(await n.slice(t,t+e).arrayBuffer())}function zy(n){return new DataView(n.buffer,n.byteOffset,n.byteLength)}var yu=class{constructor(t){this.session=t,J("speed").append(...J0.map(e=>qt("option",{value:e},`${e} ×`))),this.connectControls(),CR(e=>this.open(e)),t.listen(e=>{(e.has("player")||e.has("new"))&&this.show(),(e.has("look")||e.has("recorded"))&&this.drawOverview()}),new ResizeObserver(()=>this.drawOverview()).observe(J("overview"))}connectControls(){let t=e=>()=>this.session.player&&e(this.session.player);J("play").addEventListener("click",t(e=>e.toggle())),J("step-back").addEventListener("click",t(e=>e.step(!1))),J("step-on").addEventListener("click",t(e=>e.step(!0))),J("speed").addEventListener("change",t(e=>e.setSpeed(Number(J("speed").value)))),J("position").addEventListener("input",t(e=>e.seekSeconds(Number(J("position").value)))),J("close-recording").addEventListener("click",()=>this.close()),J("open").addEventListener("click",()=>J("file").click()),J("file").addEventListener("change",e=>{let[i]=e.target.files;e.target.value="",i&&this.open(i)})}async open(t){let e=J("said-actions"),i=(s,r)=>{e.dataset.kind=r,Bt(e,s)};i(`Opening ${t.name}.`,"progress");try{let s=o=>i(`${t.name} was cut; reading what is there: ${Math.round(o*100)} %.`,"progress"),r=await By(t,t.name,s);this.session.openPlayer(r),i("","progress")}catch(s){i(`${t.name} cannot be shown. ${s.message}`,"error")}}close(){this.session.closePlayer(),J("open").focus()}show(){let{player:t}=this.session;if(J("playback").hidden=!t,!t)return;let{recording:e}=t;Bt(J("play"),t.isPlaying?"Pause":"Play"),Bt(J("playback-name"),e.name),J("position").max=String(e.duration),J("position").value=String(t.seconds),J("position").setAttribute("aria-valuetext",vl(t.seconds)),J("speed").value=String(t.speed),Bt(J("time"),`${vl(t.seconds)} / ${vl(e.duration)}`)}drawOverview(){let t=J("overview"),{player:e,recorded:i}=this.session;if(!e||t.clientWidth===0)return;t.width=t.clientWidth*devicePixelRatio,t.height=t.clientHeight*devicePixelRatio;let{start:s,duration:r}=e.recording,a=i.strengths.map(h=>TR(h,Number(s)/1e9,r,t.width)).reduce((h,f)=>h.map((u,d)=>Math.max(u,f[d])),new Float32Array(t.width)),c=Math.max(...a)||1,l=t.getContext("2d");l.fillStyle=hr("--overview"),a.forEach((h,f)=>l.fillRect(f,t.height,1,-h/c*t.height))}};function TR({times:n,values:t},e,i,s){let r=new Float32Array(s).fill(-1),o=c=>Math.max(0,Math.min(s-1,Math.floor((c-e)/i*s)));n.forEach((c,l)=>r[o(c)]=Math.max(r[o(c)],t[l]??0));let a=n.length>0?o(n.at(-1)):0;return r.map((c,l)=>(c<0&&(r[l]=l>0&&l<=a?r[l-1]:0),r[l]))}function CR(n){let t=i=>i.dataTransfer?.types.includes("Files"),e=i=>J("drop").hidden=!i;addEventListener("dragover",i=>{t(i)&&(i.preventDefault(),e(!0))}),addEventListener("dragleave",i=>i.relatedTarget===null&&e(!1)),addEventListener("drop",i=>{if(!t(i))return;i.preventDefault(),e(!1);let[s]=i.dataTransfer.files;s&&n(s)})}var Hy=280,up=4095,xu=class{constructor(t){this.session=t,this.isSeen=!1,this.slot=null,this.plot=this.makePlot(),J("slot").addEventListener("change",()=>this.watch()),t.listen(e=>this.update(e)),new ResizeObserver(()=>this.resize()).observe(J("scope-plot"))}makePlot(){return new An({width:300,height:Hy,legend:{show:!1},cursor:{drag:{x:!0,y:!1}},scales:{x:{time:!1},y:{range:[0,up+1]}},axes:[ul({label:"ms",labelSize:18,size:30}),ul({size:48})],series:[{},{stroke:()=>hr("--accent"),width:1.25,points:{show:!1}}],hooks:{drawClear:[t=>this.shadeSettling(t)]}},[[],[]],J("scope-plot"))}setSeen(t){t!==this.isSeen&&(this.isSeen=t,this.session.wantScope(t),t&&this.resize(),t&&this.draw(),this.watch())}watch(){let t=this.isSeen&&J("slot").value!==""?Number(J("slot").value):null;t===this.slot||!this.session.offers("/dermatome/scope")||(this.slot=t,this.session.call("/dermatome/scope",{slot:t}).then(()=>Bt(J("said-scope"),""),e=>{this.slot=null,Bt(J("said-scope"),e.message)}))}update(t){t.has("new")&&(this.slot=null),t.has("skin")&&this.listSlots(),(t.has("skin")||t.has("program"))&&this.watch(),t.has("look")&&this.plot.redraw(!1,!0),t.has("scope")&&this.isSeen&&this.draw()}listSlots(){let{skin:t}=this.session.shown;if(!t)return;let e=J("slot").value||"0",i=Array.from({length:t.steps.length/4},(o,a)=>RR(t.steps,a)),s=Array.from({length:t.electrodes.length/3},(o,a)=>`test of electrode ${a+1}`),r=[...i,...s].map((o,a)=>qt("option",{value:a},`${a}: ${o}`));J("slot").replaceChildren(...r),J("slot").value=Number(e)<r.length?e:"0"}resize(){let t=J("scope-plot").clientWidth;t>0&&this.plot.setSize({width:t,height:Hy})}draw(){let{scope:t}=this.session.shown;if(!t)return this.plot.setData([[],[]]);let e=1e3/t.sample_rate,i=Array.from(t.samples,(s,r)=>r*e);this.plot.setData([i,t.samples]),Bt(J("scope-text"),IR(t))}shadeSettling(t){let{scope:e}=this.session.shown;if(!e?.settling)return;let i=t.valToPos(e.settling*1e3/e.sample_rate,"x",!0),{ctx:s,bbox:r}=t;s.save(),s.fillStyle=hr("--shade"),s.fillRect(r.left,r.top,Math.max(0,i-r.left),r.height),s.restore()}};function RR(n,t){let[e,i,s,r]=n.subarray(4*t,4*t+4).map(o=>o+1);return`current ${e} to ${i}, voltage ${s} to ${r}`}function IR({slot:n,gain:t,settling:e,period:i,sample_rate:s,samples:r}){let[o,a]=[Math.min(...r),Math.max(...r)],c=o===0||a===up?" It reaches the converter's limit: lower the gain or the amplitude.":"";return`Slot ${n}, gain ${t}: codes ${o} to ${a} of 0 to ${up}. ${Qe(s/i/1e3)} kHz carrier, ${Qe(s/1e6)} MS/s, ${i} samples a period. The first ${e} samples (shaded) are left out while the voltage settles.${c}`}function Vy(n){let t=n.protocol==="https:"?"wss":"ws",e=new URLSearchParams(n.search).get("token");return`${t}://${n.host}/${e===null?"":`?token=${encodeURIComponent(e)}`}`}var vu=class{constructor(){this.waiting=new Map}get isEmpty(){return this.waiting.size===0}put(t,e,i,s){this.waiting.set(t,{topic:t,schema:e,bytes:i,logTime:s})}take(t=()=>!0){let e=[...this.waiting.values()].filter(({topic:i})=>t(i));for(let{topic:i}of e)this.waiting.delete(i);return e}clear(){this.waiting.clear()}};var Gy='(()=>{var E="foxglove.sdk.v1";function b(s){let e=new DataView(s);switch(e.getUint8(0)){case 1:return{op:"message",subscriptionId:e.getUint32(1,!0),logTime:e.getBigUint64(5,!0),bytes:new Uint8Array(s,13)};case 2:return{op:"time",time:e.getBigUint64(1,!0)};case 3:return A(e,s);default:return}}function A(s,e){let t=s.getUint32(9,!0);return{op:"serviceResponse",serviceId:s.getUint32(1,!0),callId:s.getUint32(5,!0),payload:JSON.parse(new TextDecoder().decode(new Uint8Array(e,13+t)))}}function O(s,e,t){let n=new TextEncoder().encode("json"),i=new TextEncoder().encode(JSON.stringify(t)),r=new Uint8Array(13+n.length+i.length),o=new DataView(r.buffer);return o.setUint8(0,2),o.setUint32(1,s,!0),o.setUint32(5,e,!0),o.setUint32(9,n.length,!0),r.set(n,13),r.set(i,13+n.length),r}var a="/dermatome/";var v=["/links","/tf","/tf_static"],C=["/skin","/image","/contacts","/status"];function y(s){return s.some(({topic:e})=>e===v[0])}function m(s,e){let t=`/${e}/`;return s.startsWith(t)?a+s.slice(t.length):void 0}function I(s,e){return e.replace(a,`/${s}/`)}function k({id:s,topic:e},t,n){return t!=="*"?m(e,t):n.some(r=>C.some(o=>e===`/${r}${o}`))||v.includes(e)?`${s}${e}`:void 0}var x=[250,500,1e3,2e3,4e3,5e3],U=3e3,N=15e3,_={"/dermatome/check":12e4,"/dermatome/calibrate":12e4,"/dermatome/patch":6e4},L=15e3,H="dermatome_msgs/msg/Skin",h=class{constructor(e,t){this.url=e,this.on=t,this.isOpen=!1,this.everOpen=!1,this.attempts=0,this.retryAt=0,this.sessionId=void 0,this.notices=new Map,this.wanted=new Set,this.chosen=void 0,this.nextCall=1,this.nextSubscription=0,this.forget(),setInterval(()=>this.watch(),500),this.open()}get silence(){let e=performance.now()-this.heard;return this.isOpen&&e>U?e:0}get spaces(){return[...this.channels.values()].filter(t=>t.schemaName===H).map(({topic:t})=>t.slice(1,t.lastIndexOf("/")))}get hasRobot(){return y([...this.channels.values()])}get space(){let{spaces:e,hasRobot:t}=this;return e.includes(this.chosen)?this.chosen:t?"*":e[0]}nameHere(e){return k(e,this.space,this.spaces)}isWanted(e){return this.space!=="*"?this.wanted.has(this.nameHere(e)):(this.wanted.has(`${a}skin`)||e.topic.endsWith("/status"))&&this.nameHere(e)!==void 0}choose(e){this.chosen=e,this.beginAnew(),this.matchSubscriptions(),this.on.change()}beginAnew(){this.dropSubscriptions([...this.subscriptions.keys()]),this.on.session()}get offered(){return[...this.services.keys()].map(e=>m(e,this.space)).filter(Boolean)}want(e,t){t!==this.wanted.has(e)&&(t?this.wanted.add(e):this.wanted.delete(e),this.matchSubscriptions())}call(e,t){let n=this.services.get(I(this.space,e));if(n===void 0)return Promise.reject(new Error(this.whyNot()));let i=this.nextCall++,r=new Promise((o,u)=>{let p=setTimeout(()=>this.settle(i,f=>f.reject(new Error("The program did not answer in time."))),_[e]??L);this.calls.set(i,{resolve:o,reject:u,timer:p})});return this.socket.send(O(n,i,t)),r.then(P)}whyNot(){return this.isOpen?"The program does not offer that.":"The program does not answer."}retryNow(){this.isOpen||this.socket?.readyState===WebSocket.CONNECTING||(clearTimeout(this.timer),this.open())}open(){this.retryAt=0;let e=new WebSocket(this.url,[E]);e.binaryType="arraybuffer",e.onopen=()=>this.opened(),e.onmessage=t=>this.received(t.data),e.onclose=()=>e===this.socket&&this.closed(),this.socket=e}opened(){this.isOpen=!0,this.everOpen=!0,this.attempts=0,this.heard=performance.now(),this.on.change()}closed(){this.isOpen=!1;for(let t of[...this.calls.keys()])this.settle(t,n=>n.reject(new Error("The program went away before it answered.")));this.forget();let e=x[Math.min(this.attempts++,x.length-1)];this.retryAt=performance.now()+e,this.timer=setTimeout(()=>this.open(),e),this.on.change()}forget(){this.channels=new Map,this.subscriptions=new Map,this.services=new Map,this.calls=new Map,this.notices.clear(),this.heard=performance.now()}watch(){if(!this.isOpen)return this.retryAt&&this.on.change();let e=performance.now()-this.heard;e>N?this.drop():e>U&&this.on.change()}drop(){let{socket:e}=this;this.socket=void 0,e.close(),this.closed()}received(e){let t=this.silence>0;this.heard=performance.now();try{typeof e=="string"?this.readText(JSON.parse(e)):this.readFrame(b(e))}catch(n){console.warn("a frame of the program could not be read:",n.message)}t&&this.on.change()}readFrame(e){if(e?.op==="message"){let t=this.subscriptions.get(e.subscriptionId),n=t&&this.nameHere(t);n&&this.on.message(n,t.schema,e.bytes,e.logTime)}else e?.op==="serviceResponse"&&this.settle(e.callId,t=>t.resolve(e.payload))}readText(e){let t={serverInfo:()=>this.begin(e.sessionId),advertise:()=>e.channels.forEach(i=>this.channels.set(i.id,i)),unadvertise:()=>e.channelIds.forEach(i=>this.removeChannel(i)),advertiseServices:()=>e.services.forEach(i=>this.services.set(i.name,i.id)),unadvertiseServices:()=>e.serviceIds.forEach(i=>this.removeService(i)),serviceCallFailure:()=>this.settle(e.callId,i=>i.reject(new Error(e.message))),status:()=>this.notices.set(e.id??e.message,e),removeStatus:()=>e.statusIds.forEach(i=>this.notices.delete(i))}[e.op];if(!t)return;let{space:n}=this;t(),n!==void 0&&this.space!==void 0&&n!==this.space&&this.beginAnew(),this.matchSubscriptions(),this.on.change()}begin(e){e!==this.sessionId&&this.on.session(),this.sessionId=e}removeChannel(e){this.channels.delete(e);for(let[t,n]of this.subscriptions)n.id===e&&this.subscriptions.delete(t)}removeService(e){for(let[t,n]of this.services)n===e&&this.services.delete(t)}matchSubscriptions(){if(!this.isOpen)return;let e=r=>r.encoding==="cdr"&&r.schemaEncoding==="ros2msg",t=new Set([...this.subscriptions.values()].map(r=>r.id)),i=[...this.channels.values()].filter(r=>this.isWanted(r)&&e(r)&&!t.has(r.id)).map(r=>({id:this.nextSubscription++,channelId:r.id,channel:r}));for(let{id:r,channel:o}of i)this.subscriptions.set(r,o);i.length>0&&this.send({op:"subscribe",subscriptions:i.map(({id:r,channelId:o})=>({id:r,channelId:o}))}),this.dropUnwanted()}dropUnwanted(){let e=[...this.subscriptions].filter(([,t])=>!this.isWanted(t));this.dropSubscriptions(e.map(([t])=>t))}dropSubscriptions(e){if(e.length!==0){for(let t of e)this.subscriptions.delete(t);this.send({op:"unsubscribe",subscriptionIds:e})}}send(e){this.socket.send(JSON.stringify(e))}settle(e,t){let n=this.calls.get(e);n&&(clearTimeout(n.timer),this.calls.delete(e),t(n))}};function P(s){if(s?.ok===!0)return s;throw new Error(s?.error||"The program refused without saying why.")}var d=class{constructor(){this.waiting=new Map}get isEmpty(){return this.waiting.size===0}put(e,t,n,i){this.waiting.set(e,{topic:e,schema:t,bytes:n,logTime:i})}take(e=()=>!0){let t=[...this.waiting.values()].filter(({topic:n})=>e(n));for(let{topic:n}of t)this.waiting.delete(n);return t}clear(){this.waiting.clear()}};var $=3,l=new d,c,w=!1,g=!1,W={open:({url:s})=>c=new h(s,{message:B,session:V,change:j}),want:({topic:s,isWanted:e})=>c.want(s,e),choose:({space:s})=>c.choose(s),retry:()=>c.retryNow(),taken:()=>{w=!1,R()},call:({id:s,service:e,request:t})=>c.call(e,t).then(n=>postMessage({kind:"answer",id:s,answer:n}),n=>postMessage({kind:"answer",id:s,error:n.message}))};onmessage=({data:s})=>W[s.kind](s);function B(s,e,t,n){l.put(s,e,t,n),R()}function R(){w||g||l.isEmpty||(g=!0,setTimeout(G,$))}function G(){g=!1;let s=l.take();s.length!==0&&(w=!0,postMessage({kind:"messages",messages:s},s.map(({bytes:e})=>e.buffer)))}function V(){l.clear(),postMessage({kind:"session"})}function j(){let{isOpen:s,everOpen:e,attempts:t,retryAt:n,sessionId:i,silence:r,spaces:o,hasRobot:u,space:S,offered:p,notices:f}=c,M=n>0?n-performance.now():0;postMessage({kind:"state",state:{isOpen:s,everOpen:e,attempts:t,retryIn:M,sessionId:i,silence:r,spaces:o,hasRobot:u,space:S},services:p,notices:[...f.values()]})}})();\n';var Su=class{constructor(t,e){this.on=e,this.isOpen=!1,this.everOpen=!1,this.attempts=0,this.retryAt=0,this.silence=0,this.sessionId=void 0,this.spaces=[],this.hasRobot=!1,this.space=void 0,this.services=new Set,this.notices=[],this.calls=new Map,this.nextCall=1,this.worker=LR(),this.worker.onmessage=({data:i})=>this.told(i),this.worker.onerror=i=>e.failed(`The page's connection failed (${i.message}). Reload it.`),this.worker.postMessage({kind:"open",url:t})}get isWhole(){return this.space==="*"}offers(t){return this.services.has(t)}want(t,e){this.worker.postMessage({kind:"want",topic:t,isWanted:e})}choose(t){this.worker.postMessage({kind:"choose",space:t})}retryNow(){this.worker.postMessage({kind:"retry"})}call(t,e){let i=this.nextCall++;return this.worker.postMessage({kind:"call",id:i,service:t,request:e}),new Promise((s,r)=>this.calls.set(i,{resolve:s,reject:r}))}told(t){({messages:()=>this.take(t.messages),state:()=>this.setState(t),session:()=>this.on.session(),answer:()=>this.settle(t)})[t.kind]()}take(t){this.worker.postMessage({kind:"taken"});for(let{topic:e,schema:i,bytes:s,logTime:r}of t)this.on.message(e,i,s,r)}setState({state:{retryIn:t,...e},services:i,notices:s}){Object.assign(this,e,{notices:s,services:new Set(i)}),this.retryAt=t>0?performance.now()+t:0,this.on.change()}settle({id:t,answer:e,error:i}){let{resolve:s,reject:r}=this.calls.get(t);this.calls.delete(t),i===void 0?s(e):r(new Error(i))}};function LR(){let n=URL.createObjectURL(new Blob([Gy],{type:"text/javascript"})),t=new Worker(n);return URL.revokeObjectURL(n),t}var DR=12,bu=class{constructor(t,e){this.recording=t,this.onMore=e,this.histories=new $r(1/0),this.isClosed=!1,this.read()}get strengths(){return this.histories.all.map(t=>t.of("strength"))}close(){this.isClosed=!0}async read(){try{let t=this.recording.topics.filter(e=>/\/(contacts|status)$/.test(e));for await(let e of this.recording.walk(t))await this.addAll(e)}catch(t){console.warn("the history of the recording is not complete:",t.message)}this.isClosed||this.onMore()}async addAll(t){let e=performance.now();for(let i of t){if(this.isClosed)return;this.add(i),!(performance.now()-e<DR)&&(this.onMore(),await new Promise(s=>setTimeout(s)),e=performance.now())}}add({topic:t,schema:e,bytes:i,logTime:s}){let r=Number(s)/1e9,o=t.slice(t.lastIndexOf("/")+1);this.histories.take(El(t),o,r,fa(e,i))}};var NR=["image","contacts"];function wu({messages:n,times:t},e,i,s){let r={messages:{...n,[e]:i},times:{...t,[e]:s}};return e==="status"&&(r.times.over=OR(t.over,i,s)),r}function OR(n,t,e){return t&&t.state!=="live"?e:t&&n<e?n:void 0}function Mu({messages:n,times:t},e){let i={...n};for(let s of NR.filter(r=>r in n))e?i[s]=e[s]:t[s]<t.over&&(i[s]=void 0);return i}var UR=["/tf","/tf_static"],FR=1e3,Eu=class{constructor(){this.clear()}clear(){this.links=[],this.joints=new Map,this.skins=new Map,this.known=new Map,this.news=new Set}take(t,e,i,s){t==="/links"?this.setLinks(e?.markers??[]):UR.includes(t)?this.setJoints(e?.transforms??[]):this.setOfSkin(t,e,i,s)}setLinks(t){this.links=t,this.news.add("links")}setJoints(t){for(let{header:e,child_frame_id:i,transform:s}of t)this.joints.set(i,{parent:e.frame_id,place:BR(s)});this.news.add("joints")}setOfSkin(t,e,i,s){let[r,o]=[El(t),t.slice(t.lastIndexOf("/")+1)],a=wu(this.known.get(r)??{messages:{},times:{}},o,e,i);this.known.set(r,a);let c=this.skins.get(r)??{},l=Mu(a,s&&c);this.skins.set(r,l);for(let h of Object.keys(l))l[h]!==c[h]&&this.news.add(`${h} ${r}`)}place(t){let e=new Be,i=this.joints.get(t);for(let s=0;i&&s<FR;s++)e.premultiply(i.place),i=this.joints.get(i.parent);return e}get contacts(){return[...this.skins].flatMap(([t,{contacts:e}])=>{let i=e&&this.place(e.header.frame_id);return(e?.contacts??[]).map(s=>kR(s,i,t))})}};function BR({translation:n,rotation:t}){let e=new kn(t.x,t.y,t.z,t.w);return new Be().compose(new $().copy(n),e,new $(1,1,1))}function kR(n,t,e){let i=new $().copy(n.position).applyMatrix4(t),s=new $().copy(n.normal).transformDirection(t);return{...n,position:i,normal:s,space:e,onLink:n.position}}var zR=[Ln.skin,Ln.status,Ln.image,Ln.contacts,Ln.health],HR=new Set([Ln.image,Ln.contacts,Ln.health,Ln.scope]),VR=/^\d.*\/(image|contacts|tf)$/,GR=Object.fromEntries(Object.entries(Ln).map(([n,t])=>[t,n])),WR=2e3,$R=2e3,Au=class{constructor(t){this.listeners=[],this.changes=new Set,this.latest=new vu,this.robot=new Eu,this.known={messages:{},times:{}},this.shown={},this.liveStatus=void 0,this.player=void 0,this.isHeld=!1,this.isScopeWanted=!1,this.fault="",this.lack="",this.imageCame=0,this.latencies=[],this.program=new Su(Vy(t),{message:(...e)=>this.fromProgram(...e),session:()=>this.begin(),change:()=>this.changed("program"),failed:e=>this.failed(e)}),this.subscribe(),setInterval(()=>this.watch(),500)}listen(t){return this.listeners.push(t),()=>this.listeners=this.listeners.filter(e=>e!==t)}changed(t){this.changes.size===0&&requestAnimationFrame(()=>this.frame()),this.changes.add(t)}call(t,e={}){return this.player?Promise.reject(new Error("A recording is shown. Close it to control the skin.")):this.program.call(t,e)}offers(t){return this.program.isOpen&&!this.player&&this.program.offers(t)}hold(t){this.isHeld=t,this.changed("held")}get isStale(){return!this.player&&!this.isHeld&&this.program.isOpen&&this.shown.status?.state==="live"&&!document.hidden&&performance.now()-this.imageCame>WR}get source(){return this.player?.recording??this.program}get isWhole(){return this.source.isWhole}get skins(){return this.isWhole?[...this.robot.known].map(([t,{times:e}])=>({space:t,shown:this.robot.skins.get(t),times:e})):[{space:Ml,shown:this.shown,times:this.known.times}]}wantScope(t){this.isScopeWanted=t,this.subscribe()}openPlayer(t){this.endPlayer(),this.stopScope(),this.forget(),this.isHeld=!1,this.recorded=new bu(t,()=>this.changed("recorded")),this.player=new Zh(t,{message:(...e)=>this.receive(...e),change:()=>this.changed("player"),error:e=>this.failed(`The recording cannot be read here: ${e.message}.`)}),this.subscribe(),this.changed("player")}chooseRecorded(t){let{recording:e,position:i,speed:s,isPlaying:r}=this.player;this.openPlayer(e.of(t)),this.player.setSpeed(s),this.player.seek(i),r&&this.player.play()}closePlayer(){this.endPlayer(),this.forget(),this.subscribe(),this.changed("player")}stopScope(){this.isScopeWanted&&this.program.call("/dermatome/scope",{slot:null}).catch(()=>{})}endPlayer(){this.player?.close(),this.recorded?.close(),this.player=this.recorded=void 0}subscribe(){for(let t of zR)this.program.want(t,!this.player||t===Ln.status);this.program.want(Ln.scope,this.isScopeWanted&&!this.player),!this.player&&this.liveStatus&&(this.known.messages.status=this.shown.status=this.liveStatus)}begin(){this.liveStatus=void 0,this.player||this.forget()}forget(){this.latest.clear(),this.known={messages:{},times:{}},this.shown={},this.robot.clear(),this.fault="",this.imageCame=performance.now();for(let t of Object.keys(Ln))this.changed(t);this.changed("new")}fromProgram(t,e,i,s){this.player&&t===Ln.status&&this.followStatus(e,i),this.player||this.receive(t,e,i,s)}followStatus(t,e){this.liveStatus=fa(t,e),this.changed("liveStatus")}receive(t,e,i,s){t===Ln.image&&(this.imageCame=performance.now()),this.latest.put(t,e,i,s),this.changed("messages")}frame(){let t=i=>this.isHeld&&(HR.has(i)||VR.test(i));for(let i of this.latest.take(s=>!t(s)))this.take(i);this.settle();let{changes:e}=this;this.changes=new Set;for(let i of this.listeners)this.tell(i,e);e.has("image")&&this.shown.image&&this.noteLatency()}tell(t,e){try{t(e)}catch(i){console.error(i),this.failed(`A part of the page failed (${i.message}). Reload it.`)}}take({topic:t,schema:e,bytes:i,logTime:s}){let r=GR[t];try{let o=i&&fa(e,i);if(!t.startsWith("/"))return this.takeOfRobot(t.slice(t.indexOf("/")),o,s);o&&r==="skin"&&of(o),this.known=wu(this.known,r,o,s),r==="status"&&!this.player&&(this.liveStatus=o)}catch(o){this.failed(`A message of ${t} cannot be read (${o.message}). Reload the page: the program may be newer.`)}}takeOfRobot(t,e,i){e&&t.endsWith("/skin")&&of(e),this.robot.take(t,e,i,this.isHeld),this.changes.add("robot")}settle(){let t=this.shown;this.shown=Mu(this.known,this.isHeld&&t);for(let e of Object.keys(this.shown))this.shown[e]!==t[e]&&this.changes.add(e)}noteLatency(){let{image:t}=this.known.times;this.player||t===void 0||(this.latencies.push(performance.timeOrigin+performance.now()-Number(t)/1e6),this.latencies.length>$R&&this.latencies.shift())}lacks(t){this.lack=t,this.changed("program")}failed(t){t!==this.fault&&(this.fault=t,this.changed("program"))}watch(){this.isStale!==this.wasStale&&this.changed("program"),this.wasStale=this.isStale}};var XR=[12.5,20,50,100,200],qR=[0,1,2,4,8,16,32,64];function $y(n,t){Tu(J("frequency"),XR.map(r=>[r*1e3,`${r} kHz`])),Tu(J("gain"),qR.map(r=>[r,r===0?"automatic":String(r)])),Tu(J("map"),Object.entries(gr).map(([r,{title:o}])=>[r,o]));let e=ZR(n),i=jR(n);JR(n);let s=QR(n,t);n.listen(r=>{["status","program","player","new"].some(o=>r.has(o))&&(YR(n),n.shown.status&&[e,i].forEach(o=>o(n.shown.status))),(r.has("look")||r.has("image"))&&s()}),s()}function YR(n){let t={"drive-form":"drive","threshold-form":"threshold","patch-form":"patch"};for(let[e,i]of Object.entries(t)){let s=n.offers(`/dermatome/${i}`);for(let r of J(e).elements)r.tagName!=="OUTPUT"&&(r.disabled=!s)}}function ZR(n){let t=J("drive-form"),e=!1;return t.addEventListener("input",()=>e=!0),t.addEventListener("submit",i=>{i.preventDefault();let s=KR(J("amplitude"),n.shown.status?.largest_amplitude*1e3);if(s.error)return Bt(J("said-drive"),s.error);let r={frequency_hz:Number(J("frequency").value),amplitude_ma:s.value,gain:Number(J("gain").value)};Cu(n,"drive",r).then(o=>o&&(e=!1))}),i=>{Bt(J("drive-now"),`In effect: ${$u(i)}.`),J("amplitude").max=String(Ru(i.largest_amplitude*1e3)),!(e||t.contains(document.activeElement))&&(Wy(J("frequency"),Math.round(i.frequency),`${Qe(i.frequency/1e3)} kHz`),J("amplitude").value=Ru(i.amplitude*1e3),Wy(J("gain"),i.gain,String(i.gain)))}}function KR(n,t){let e=n.value.trim()===""?NaN:Number(n.value);return e>0?t>0&&e>t*1.0001?{error:`The board drives ${Ru(t)} mA at most.`}:{value:e}:{error:"The amplitude is a number above 0, in mA."}}function JR(n){J("threshold-form").addEventListener("submit",t=>{t.preventDefault();let e=J("threshold").value.trim()===""?NaN:Number(J("threshold").value);if(!(e>=0))return Bt(J("said-threshold"),"The strength is a number from 0, such as 0.05.");Cu(n,"threshold",{value:e})}),J("threshold-default").addEventListener("click",()=>{J("threshold").value="",Cu(n,"threshold",{value:0})}),n.listen(t=>{let e=n.shown.skin?.contact_threshold;t.has("skin")&&e>0&&(J("threshold").placeholder=String(Ru(e)))})}function jR(n){let t=J("patch");J("patch-form").addEventListener("submit",i=>i.preventDefault()),t.addEventListener("change",()=>Cu(n,"patch",{index:Number(t.value)}));let e="";return i=>{let s=JSON.stringify(i.patches);s!==e&&Tu(t,i.patches.map((r,o)=>[o,r])),e=s,document.activeElement!==t&&(t.value=String(i.patch))}}async function Cu(n,t,e){let i=J(`said-${t}`);try{return await n.call(`/dermatome/${t}`,e),Bt(i,""),!0}catch(s){return Bt(i,s.message),!1}}function QR(n,t){let{scale:e}=t,i=()=>n.changed("look");J("colour-form").addEventListener("submit",s=>s.preventDefault()),J("map").addEventListener("change",()=>t.setMap(J("map").value)),J("scale-automatic").addEventListener("change",s=>{e.setAutomatic(s.target.checked),i()}),J("scale-maximum").addEventListener("change",s=>{let r=Number(s.target.value);r>0&&e.setFixed(r),i()});for(let s of["contacts","electrodes","link"])J(`show-${s}`).addEventListener("change",r=>t.setShown({[s]:r.target.checked}));return()=>tI(t)}function tI({map:n,scale:t,shows:e}){J("map").value=n,J("scale-automatic").checked=t.isAutomatic,document.activeElement!==J("scale-maximum")&&(J("scale-maximum").value=Number(t.maximum.toPrecision(2)));for(let[i,s]of Object.entries(e))J(`show-${i}`).checked=s}function Tu(n,t){n.replaceChildren(...t.map(([e,i])=>qt("option",{value:e},i)))}function Wy(n,t,e){[...n.options].some(s=>s.value===String(t))||n.append(qt("option",{value:t},e)),n.value=String(t)}function Ru(n){return Number(Number(n).toPrecision(4))}function Xy(n){let t=J("skin-choice");t.addEventListener("change",()=>{n.player?n.chooseRecorded(t.value):n.program.choose(t.value)}),n.listen(e=>{(e.has("program")||e.has("player"))&&eI(n.source,t)})}function eI({spaces:n,space:t,hasRobot:e},i){let s=e?["*",...n]:n;i.hidden=s.length<2,Gn(i,s,()=>qt("option"),(r,o)=>{r.value=o,Bt(r,o==="*"?"Whole robot":o)}),t!==void 0&&(i.value=t)}function qy(n){if(n.player)return nI(n);if(!n.program.isOpen)return iI(n.program);if(n.program.silence>0)return rI(n.program.silence);if(n.isWhole)return sI(n.robot);let{status:t,skin:e}=n.shown;return t?t.state!=="live"?oI(t):e?aI(t):pl("Waiting for the skin's shape",t.text):pl("Connected to the program","It has not yet said how the skin is.")}function nI({player:n,shown:t,robot:e,isWhole:i,fault:s}){let{recording:r}=n,o=r.isCut?"The file was cut: it is shown up to its last whole chunk.":"",c=!(i?[...e.skins.values()].some(({skin:l})=>l):t.skin)&&!s;return{level:"off",word:"Recording",text:c?"The skin's shape is not in the recording, or not yet read":r.name,advice:o,covers:c}}function iI(n){if(!n.everOpen&&n.attempts===0)return pl("Connecting to the program","");let t=Math.ceil((n.retryAt-performance.now())/1e3);return{level:"bad",word:"No program",text:"The program `dermatome view` does not answer",advice:`Start it again in a terminal, if it has ended; this page connects by itself. ${n.retryAt>0&&t>0?`The next attempt is in ${t} s.`:"Trying now."}`,covers:!0,action:"retry"}}function sI({skins:n}){let t=[...n].filter(([,{status:r}])=>r);if(t.length===0)return pl("Connected to the program","It has not yet said how the skins are.");let e=t.filter(([,{status:r}])=>r.state!=="live"),i=e.map(([r,{status:o}])=>`${r}: ${o.text||(Wr[o.state]?.word??o.state)}`);if(e.length===t.length)return pl("No skin is live",i.join("; "));let s=e.length===0;return{level:s?"good":"warn",word:s?"Live":`${t.length-e.length} of ${t.length} live`,text:s?`${t.length} skins`:i.join("; "),advice:e.map(([,{status:r}])=>r.advice).find(Boolean)??"",covers:!1}}function rI(n){return{level:"warn",word:"Silent",text:`The program has said nothing for ${Math.round(n/1e3)} s`,advice:"It may be busy, or the machine was asleep. If it goes on, look at its terminal.",covers:!1}}function oI(n){let{word:t,level:e}=Wr[n.state]??{word:n.state,level:"warn"},i=n.state==="not_tared"?"tare":void 0;return{level:e,word:t,text:n.text||t,advice:n.advice,covers:!0,action:i}}function aI(n){let{word:t,level:e}=Wr[n.state];return{level:e,word:t,text:n.text,advice:n.advice,covers:!1}}function pl(n,t){return{level:"off",word:"Waiting",text:n,advice:t,covers:!0}}function lI({skins:n}){return[...n].flatMap(([t,{status:e}])=>(e?.warnings??[]).map(i=>`${t}: ${i}`))}function Yy(n){let{status:t}=n.shown,e=n.player?[]:n.program.notices.filter(({level:a})=>a>0),i=n.isStale?["No new image has come for some seconds, although the program says that the skin is live."]:[],r=n.player||n.program.isOpen?n.isWhole?lI(n.robot):t?.warnings??[]:[],o=[n.lack,n.fault,...i,...r,...e.map(({message:a})=>a)];return[...new Set(o.filter(a=>a))]}var cI=4e3,Zy={tare:"Tare",retry:"Try now"};function Ky(n,t){let e=J("situation-action"),i=new Map;e.addEventListener("click",()=>t(e.dataset.action)),n.listen(s=>{s.has("new")&&i.clear(),["status","program","player","skin","new","held","robot"].some(r=>s.has(r))&&hI(n,e,i)})}function hI(n,t,e){let i=qy(n),s=J("state");Bt(s,i.word),s.dataset.level=i.level,Bt(J("status-text"),i.text),J("status-text").title=i.advice,document.title=`${n.isWhole?n.source.spaces[0].split("/")[0]:n.shown.skin?.name??i.word} – Dermatome`,J("situation").hidden=!i.covers,J("view").classList.toggle("is-dimmed",i.covers),J("panel-contacts").classList.toggle("is-dimmed",i.covers&&i.action==="retry"),Bt(J("situation-text"),i.text),Bt(J("situation-advice"),i.advice),t.hidden=!(i.action in Zy),t.dataset.action=i.action??"",Bt(t,Zy[i.action]??""),J("held").hidden=!n.isHeld||i.covers,uI(n,i,e)}function uI(n,{covers:t,advice:e},i){let s=performance.now();for(let o of Yy(n))i.set(o,s);for(let[o,a]of i)s-a>cI&&i.delete(o);let r=[...i.keys()].map(o=>({text:o,kind:"warning"}));!t&&e&&r.push({text:e,kind:"hint"}),Gn(J("banners"),r,()=>qt("li"),(o,{text:a,kind:c})=>{o.dataset.kind=c,Bt(o,a)})}function Jy(n,t,e){window.dermatome=Object.freeze({state:()=>dI(n,t,e),get framesDrawn(){return t.framesDrawn},get lastDrawnDeviceTime(){return t.lastDrawnDeviceTime},get latencies(){return[...n.latencies]},project:(i,s,r)=>t.scene.project({x:i,y:s,z:r})})}function fI(n,t){let e=n.contacts.map(({space:s,position:r,onLink:o})=>({space:s,position:{...r},onLink:o})),{figure:i}=t.scene;return{contacts:e,skins:[...i?.skins.keys()??[]],links:(i?.links??[]).map(({frame:s})=>s)}}function dI(n,t,e){let{player:i,program:s,shown:r}=n;return{isOpen:s.isOpen,sessionId:s.sessionId,state:r.status?.state,skin:r.skin?.name,isFlat:t.scene?.frame?.isFlat,sequence:r.image?.sequence,contacts:(r.contacts?.contacts??[]).map(({id:o,force:a,strength:c,position:l})=>({id:o,force:a,strength:c,position:l})),robot:n.isWhole?fI(n.robot,t):void 0,isHeld:n.isHeld,panel:e.selected,map:t.map,range:t.range,isScaleAutomatic:t.scale.isAutomatic,theme:document.documentElement.dataset.theme,recording:i&&{seconds:i.seconds,duration:i.recording.duration,isPlaying:i.isPlaying,isCut:i.recording.isCut}}}var jy="dermatome-theme";function tx(n,t){let e=matchMedia("(prefers-color-scheme: dark)"),i=o=>{let a=o==="dark"||o==="system"&&e.matches;document.documentElement.dataset.theme=a?"dark":"light",t()},s=()=>n.find(o=>o.checked)?.value??"system",r=Qy();for(let o of n)o.checked=o.value===r,o.addEventListener("change",()=>i(Qy(s())));e.addEventListener("change",()=>i(s())),i(s())}function Qy(n){try{return n!==void 0&&localStorage.setItem(jy,n),n??localStorage.getItem(jy)??"system"}catch{return n??"system"}}var Ze=new Au(location),Ki=new Yh(Ze,{keepsPixels:new URLSearchParams(location.search).has("test")}),{tare:nx,record:pI}=Up(Ze);Ky(Ze,n=>n==="tare"?nx():Ze.program.retryNow());$y(Ze,Ki);Xy(Ze);kp(Ze);new yu(Ze);var mI={contacts:Kp(Ze),plots:new fu(Ze),electrodes:Nm(Ze),scope:new xu(Ze)},fp=new Vl(n=>{for(let[t,e]of Object.entries(mI))e.setSeen(t===n)});function ix(){Ze.player?Ze.player.toggle():Ze.hold(!Ze.isHeld)}function sx(){let n=Object.keys(gr);Ki.setMap(n[(n.indexOf(Ki.map)+1)%n.length])}function ex(n){n(Ki.scale),Ze.changed("look")}Bm(Ze,{tare:nx,record:pI,hold:ix,step:n=>Ze.player?.step(n),open:()=>J("open").click(),dismiss:()=>Bt(J("said-actions"),""),map:sx,automatic:()=>ex(n=>n.setAutomatic(!n.isAutomatic)),scale:n=>ex(t=>t.step(n)),electrodes:()=>Ki.setShown({electrodes:!Ki.shows.electrodes}),reset:()=>Ki.scene?.resetView(),turn:(n,t)=>Ki.scene?.turn(n,t),zoom:n=>Ki.scene?.zoom(n),panel:n=>fp.select(n)});J("pause").addEventListener("click",ix);J("next-map").addEventListener("click",sx);J("reset-view").addEventListener("click",()=>Ki.scene?.resetView());Ze.listen(n=>{!n.has("held")&&!n.has("player")&&!n.has("new")||(J("pause").setAttribute("aria-pressed",String(Ze.isHeld)),J("pause").disabled=!!Ze.player)});tx([...document.querySelectorAll("input[name=theme]")],()=>Ze.changed("look"));Jy(Ze,Ki,fp);fp.select("contacts");Ze.changed("program");
/*! Bundled license information:

three/build/three.core.js:
three/build/three.module.js:
  (**
   * @license
   * Copyright 2010-2026 Three.js Authors
   * SPDX-License-Identifier: MIT
   *)
*/
