// What a visitor may turn: views, exposure, baked light, groups of lamps, the error map.
import * as THREE from 'three';

const element = ( id ) => document.getElementById( id );

// Discs on the surfaces, red where this page shows too much light and blue where too little.
async function makeErrorMap( errors ) {

	const data = new DataView( await ( await fetch( errors.file ) ).arrayBuffer() );
	const discs = new THREE.InstancedMesh( new THREE.CircleGeometry( errors.radius_m, 6 ),
		new THREE.MeshBasicMaterial( { toneMapped: false } ), errors.count );
	const white = new THREE.Color( '#f7f7f7' ), red = new THREE.Color( '#b2182b' ), blue = new THREE.Color( '#2166ac' );
	const z = new THREE.Vector3( 0, 0, 1 ), n = new THREE.Vector3(), p = new THREE.Vector3(), colour = new THREE.Color();
	const turn = new THREE.Quaternion(), one = new THREE.Vector3( 1, 1, 1 ), matrix = new THREE.Matrix4();
	for ( let i = 0; i < errors.count; i ++ ) {

		const at = 10 * i;
		for ( let axis = 0; axis < 3; axis ++ ) {

			p.setComponent( axis, errors.low[ axis ] + errors.extent[ axis ] * data.getUint16( at + 2 * axis, true ) / 65535 );
			n.setComponent( axis, data.getInt8( at + 6 + axis ) / 127 );

		}

		n.normalize();
		turn.setFromUnitVectors( z, n );
		discs.setMatrixAt( i, matrix.compose( p.addScaledVector( n, 0.1 * errors.radius_m ), turn, one ) );
		const off = data.getInt8( at + 9 ) / 127;
		discs.setColorAt( i, colour.lerpColors( white, off > 0 ? red : blue, Math.abs( off ) ) );

	}

	discs.frustumCulled = false;
	return discs;

}

export function addControls( page ) {

	const { about } = page;
	document.title = about.title;
	element( 'title' ).textContent = about.title;
	about.views.forEach( ( view, i ) => element( 'view' ).add( new Option( view.name, i ) ) );
	element( 'view' ).onchange = ( e ) => {

		page.look( Number( e.target.value ) );
		page.draw();

	};
	element( 'exposure' ).oninput = ( e ) => {

		page.stops = Number( e.target.value );
		element( 'exposure-text' ).textContent = `${ page.stops > 0 ? '+' : '' }${ page.stops } stops`;
		page.draw();

	};

	const divider = element( 'divider' );
	const setMode = ( mode ) => {

		page.mode = mode;
		divider.hidden = mode !== 'split';
		divider.style.left = `${ 100 * page.split }%`;
		for ( const input of document.getElementsByName( 'grid' ) ) input.checked = input.value === mode;
		page.draw();

	};
	for ( const input of document.getElementsByName( 'grid' ) ) input.onchange = () => setMode( input.value );
	divider.onpointerdown = ( e ) => divider.setPointerCapture( e.pointerId );
	divider.onpointermove = ( e ) => {

		if ( ! divider.hasPointerCapture( e.pointerId ) ) return;
		page.split = Math.min( Math.max( e.clientX / window.innerWidth, 0 ), 1 );
		setMode( 'split' );

	};
	window.addEventListener( 'keydown', ( e ) => {

		if ( e.key === 'g' && ! e.ctrlKey ) setMode( page.mode === 'on' ? 'off' : 'on' );

	} );
	window.addEventListener( 'resize', () => {

		page.resize();
		page.draw();

	} );

	const names = new Set( [ ...about.groups.map( ( g ) => g.name ) ] );
	// Without groups the grid keeps the light of all lamps as it was baked: there is nothing to dim.
	element( 'lights' ).hidden = names.size === 0;
	for ( const name of names ) {

		const label = document.createElement( 'label' );
		const input = Object.assign( document.createElement( 'input' ), { type: 'range', min: 0, max: 2, step: 0.05, value: 1 } );
		input.dataset.group = name;
		input.oninput = () => page.setLights( name, Number( input.value ) );
		label.append( name, input );
		element( 'lights' ).append( label );

	}

	const percent = `${ ( 100 * about.errors.full ).toFixed( 0 ) } %`;
	element( 'scale-text' ).textContent = `${ percent } of mean E too dark … ${ percent } too bright`;
	let discs = null;
	element( 'errors' ).onchange = async ( e ) => {

		if ( discs === null ) page.scene.add( discs = await makeErrorMap( about.errors ) );
		discs.visible = e.target.checked;
		element( 'legend' ).hidden = ! e.target.checked;
		page.draw();

	};

	for ( const [ name, value ] of about.numbers ) {

		const row = element( 'numbers' ).insertRow();
		row.insertCell().textContent = name;
		row.insertCell().textContent = value;

	}

	for ( const note of about.notes ) element( 'notes' ).append( Object.assign( document.createElement( 'li' ), { textContent: note } ) );

}
